; RampBuffer::publish, and Corrector::advance for the first gyro sample after it.
;@ function prove_take_over

;@ define
(define-fun half ((x F32)) F32 (fp.mul RNE x ((_ to_fp 8 24) RNE 0.5)))
(define-fun is_early () Bool
  (and (distinct |ramp.samples| (_ bv0 16)) (bvsgt (left valid) samples)))
; Of the new ramp.
(define-fun steps () (_ BitVec 32)
  (bvmul (_ bv2 32) (bvsub ((_ zero_extend 16) |ramp.samples|) (_ bv1 32))))
(define-fun first_bias ((end F32) (slope F32)) F32
  (fp.sub RNE end (fp.mul RNE ((_ to_fp_unsigned 8 24) RNE (not_negative steps)) (half slope))))

;@ claim bias abstract: the first gyro sample gets the bias of the new ramp, one sample along it
(and
  (= |bias'.0| (first_bias |ramp.end.0| |ramp.slope.0|))
  (= |bias'.1| (first_bias |ramp.end.1| |ramp.slope.1|))
  (= |bias'.2| (first_bias |ramp.end.2| |ramp.slope.2|)))

;@ claim flags: and its flags, early or not, and never late
(= |status'.value| (ite is_early (bvor |ramp.status| (_ bv16 16)) |ramp.status|))

;@ claim steps: the new ramp has one sample less left, the former one as many as before
(and
  (= (left_after valid_after) steps)
  (= valid_after other)
  (= (left_after valid) (left valid)))
