; PulseCorrector::status. One step is one gyro sample.
;@ function prove_pulse_status

;@ define
(define-fun is_late () Bool
  (and (distinct samples (_ bv0 32))
       (bvslt (bvadd (wide (left valid)) (wide samples)) (_ bv0 34))))

;@ claim kept: nothing in the buffer is changed
(and only_steps (= (left_after valid) (left valid)))

;@ claim flags: INTERVAL_INVALID is added if and only if the ramp has samples and is late by more than as many, and no other flag is
(= |status'.value| (ite is_late (bvor flags (_ bv16 16)) flags))
