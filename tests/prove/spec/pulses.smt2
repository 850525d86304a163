; PulseCorrector::correct. One step is one gyro sample.
;@ function prove_pulses

;@ define
; Numbers of 2^-26 pulses, exact.
(define-fun exact ((x (_ BitVec 32))) (_ BitVec 64) ((_ sign_extend 32) x))
(define-fun rest_of ((x (_ BitVec 64))) (_ BitVec 64) (bvand x (_ bv67108863 64)))
(define-fun steps () (_ BitVec 32) (not_negative (left_after valid)))
(define-fun word_of ((first (_ BitVec 32)) (second (_ BitVec 32))) (_ BitVec 64)
  (exact (word valid first second)))
(define-fun way_0 () (_ BitVec 64)
  (bvmul (word_of |ramps.slopes.0.0| |ramps.slopes.0.1|) (exact steps)))
(define-fun bias_0 () (_ BitVec 64)
  (bvsub (word_of |ramps.ends.0.0| |ramps.ends.0.1|) way_0))
(define-fun way_1 () (_ BitVec 64)
  (bvmul (word_of |ramps.slopes.1.0| |ramps.slopes.1.1|) (exact steps)))
(define-fun bias_1 () (_ BitVec 64)
  (bvsub (word_of |ramps.ends.1.0| |ramps.ends.1.1|) way_1))
(define-fun way_2 () (_ BitVec 64)
  (bvmul (word_of |ramps.slopes.2.0| |ramps.slopes.2.1|) (exact steps)))
(define-fun bias_2 () (_ BitVec 64)
  (bvsub (word_of |ramps.ends.2.0| |ramps.ends.2.1|) way_2))
(define-fun fifteen () (_ BitVec 64) (_ bv1006632960 64))
(define-fun bounded ((bias (_ BitVec 64))) Bool
  (and (bvsle (bvneg fifteen) bias) (bvsle bias fifteen)))
(define-fun carry ((carried (_ BitVec 32))) Bool (bvult carried (_ bv67108864 32)))
; Pulses that are taken out.
(define-fun taken ((before (_ BitVec 32)) (after (_ BitVec 32))) (_ BitVec 32) (bvsub before after))
(define-fun least () (_ BitVec 32) (bvneg (_ bv131073 32)))

;@ assume bias: no bias of a ramp is beyond 15 pulses (proved of PulseRamp::new)
(and
  (bounded bias_0)
  (bounded bias_1)
  (bounded bias_2))

;@ assume carry: a part of a pulse, as PulseCorrector::new has it and as it is kept
(and
  (carry |corrector.carried.0|)
  (carry |corrector.carried.1|)
  (carry |corrector.carried.2|))

;@ assume left: no more than the longest ramp has, and no less than where the count ends
(ticks_within (left valid) least (_ bv65535 32))

;@ claim steps: one step fewer is left, and 131073 after the end the count stays
(= (left_after valid)
   (ite (= (left valid) least) least (bvsub (left valid) (_ bv1 32))))

;@ claim kept_left: so what is left stays within the numbers that are assumed, and the count never wraps
(ticks_within (left_after valid) least (_ bv65535 32))

;@ claim kept: nothing else in the buffer is written
only_steps

;@ claim kept_carry: what is carried is 0 to below 2^26
(and
  (carry |corrector'.carried.0|)
  (carry |corrector'.carried.1|)
  (carry |corrector'.carried.2|))

;@ define
; The bias in 32 bits, as the code has it.
(define-fun narrow_0 () (_ BitVec 32)
  (bvsub (word valid |ramps.ends.0.0| |ramps.ends.0.1|)
         (bvmul steps (word valid |ramps.slopes.0.0| |ramps.slopes.0.1|))))
(define-fun narrow_1 () (_ BitVec 32)
  (bvsub (word valid |ramps.ends.1.0| |ramps.ends.1.1|)
         (bvmul steps (word valid |ramps.slopes.1.0| |ramps.slopes.1.1|))))
(define-fun narrow_2 () (_ BitVec 32)
  (bvsub (word valid |ramps.ends.2.0| |ramps.ends.2.1|)
         (bvmul steps (word valid |ramps.slopes.2.0| |ramps.slopes.2.1|))))

;@ claim low: the way to the end in 32 bits is the lower half of the exact one
(and
  (= ((_ extract 31 0) way_0)
     (bvmul steps (word valid |ramps.slopes.0.0| |ramps.slopes.0.1|)))
  (= ((_ extract 31 0) way_1)
     (bvmul steps (word valid |ramps.slopes.1.0| |ramps.slopes.1.1|)))
  (= ((_ extract 31 0) way_2)
     (bvmul steps (word valid |ramps.slopes.2.0| |ramps.slopes.2.1|))))

;@ claim fits by low: so the bias in 32 bits is the exact one
(and
  (= bias_0 (exact narrow_0)) (bounded (exact narrow_0))
  (= bias_1 (exact narrow_1)) (bounded (exact narrow_1))
  (= bias_2 (exact narrow_2)) (bounded (exact narrow_2)))

;@ claim pulses_0 by fits: axis 0: what was carried and the bias are the whole pulses that are taken out and what is carried then, exactly
(= (bvadd (exact |corrector.carried.0|) (exact narrow_0))
   (bvadd (bvmul (exact (taken |pulses.0| |rest'.0|)) (_ bv67108864 64))
          (exact |corrector'.carried.0|)))

;@ claim pulses_1 by fits: axis 1: what was carried and the bias are the whole pulses that are taken out and what is carried then, exactly
(= (bvadd (exact |corrector.carried.1|) (exact narrow_1))
   (bvadd (bvmul (exact (taken |pulses.1| |rest'.1|)) (_ bv67108864 64))
          (exact |corrector'.carried.1|)))

;@ claim pulses_2 by fits: axis 2: what was carried and the bias are the whole pulses that are taken out and what is carried then, exactly
(= (bvadd (exact |corrector.carried.2|) (exact narrow_2))
   (bvadd (bvmul (exact (taken |pulses.2| |rest'.2|)) (_ bv67108864 64))
          (exact |corrector'.carried.2|)))

;@ claim taken_0 by fits: axis 0: no more than 15 pulses are taken out of a gyro sample
(ticks_within (taken |pulses.0| |rest'.0|) (bvneg (_ bv15 32)) (_ bv15 32))

;@ claim taken_1 by fits: axis 1: no more than 15 pulses are taken out of a gyro sample
(ticks_within (taken |pulses.1| |rest'.1|) (bvneg (_ bv15 32)) (_ bv15 32))

;@ claim taken_2 by fits: axis 2: no more than 15 pulses are taken out of a gyro sample
(ticks_within (taken |pulses.2| |rest'.2|) (bvneg (_ bv15 32)) (_ bv15 32))
