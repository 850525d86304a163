; Corrector::correct. Steps are halves of gyro samples.
;@ function prove_correct

;@ define
(define-fun steps () (_ BitVec 32) (not_negative (left_after valid)))

;@ claim steps: two steps fewer are left, down to the least number there is
(= (left_after valid) (difference (left valid) (_ bv2 32)))

;@ claim kept: nothing else in the buffer is written
only_steps

;@ claim out abstract: each gyro sample less its bias, rounded once
(and
  (= |out'.0| (fp.sub RNE |raw.0| (bias end_0 slope_0 steps)))
  (= |out'.1| (fp.sub RNE |raw.1| (bias end_1 slope_1 steps)))
  (= |out'.2| (fp.sub RNE |raw.2| (bias end_2 slope_2 steps))))
