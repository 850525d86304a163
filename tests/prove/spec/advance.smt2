; Corrector::advance for one gyro sample. Steps are halves of gyro samples.
;@ function prove_advance

;@ define
(define-fun steps () (_ BitVec 32) (not_negative (left_after valid)))
(define-fun is_late () Bool
  (and (distinct samples (_ bv0 32))
       (bvslt (bvadd (wide (left_after valid)) (wide samples) (wide samples)) (_ bv0 34))))
(define-fun most () F32 ((_ to_fp 8 24) RNE 1000000000000000000000000000000.0))
(define-fun bounded ((x F32)) Bool (within x (fp.neg most) most))

;@ claim steps: two steps fewer are left, down to the least number there is
(= (left_after valid) (difference (left valid) (_ bv2 32)))

;@ claim kept: nothing else in the buffer is written
only_steps

;@ claim bias abstract: the end less the slope times the steps that are left, and from the end of the ramp on the end
(and
  (= |bias'.0| (bias end_0 slope_0 steps))
  (= |bias'.1| (bias end_1 slope_1 steps))
  (= |bias'.2| (bias end_2 slope_2 steps)))

;@ claim level: where no step is left the bias is the end, for any finite slope
(=> (= steps (_ bv0 32))
  (and
    (=> (finite slope_0) (same |bias'.0| end_0))
    (=> (finite slope_1) (same |bias'.1| end_1))
    (=> (finite slope_2) (same |bias'.2| end_2))))

;@ claim flag_interval: INTERVAL_INVALID is added if and only if the ramp has samples and is late by more than as many, and no other flag is
(= |status'.value| (ite is_late (bvor flags (_ bv16 16)) flags))

;@ claim finite: the bias is finite where end and slope are within 1e30 and no more is left than the longest ramp has
(=> (bvsle (left valid) (_ bv131070 32))
  (and
    (=> (and (bounded end_0) (bounded slope_0)) (finite |bias'.0|))
    (=> (and (bounded end_1) (bounded slope_1)) (finite |bias'.1|))
    (=> (and (bounded end_2) (bounded slope_2)) (finite |bias'.2|))))
