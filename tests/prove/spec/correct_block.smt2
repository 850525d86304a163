; Corrector::correct_block for eight gyro samples. Steps are halves of gyro samples.
;@ function prove_correct_block

;@ define
; Steps left after so many single samples.
(define-fun after ((steps (_ BitVec 32))) (_ BitVec 32) (difference steps (_ bv2 32)))
(define-fun after_4 ((steps (_ BitVec 32))) (_ BitVec 32) (after (after (after (after steps)))))
(define-fun middle () (_ BitVec 32) (not_negative (difference (left valid) (_ bv9 32))))
(define-fun long ((x (_ BitVec 32))) (_ BitVec 36) ((_ sign_extend 4) x))
(define-fun bias_0 () F32 (bias end_0 slope_0 middle))
(define-fun bias_1 () F32 (bias end_1 slope_1 middle))
(define-fun bias_2 () F32 (bias end_2 slope_2 middle))

;@ claim steps: as many steps are left as after eight single gyro samples
(= (left_after valid) (after_4 (after_4 (left valid))))

;@ claim kept: nothing else in the buffer is written
only_steps

;@ claim one_bias abstract: all gyro samples of an axis get one bias
(and
  (= |block'.0| (fp.sub RNE |block.0| bias_0))
  (= |block'.1| (fp.sub RNE |block.1| bias_1))
  (= |block'.2| (fp.sub RNE |block.2| bias_2))
  (= |block'.3| (fp.sub RNE |block.3| bias_0))
  (= |block'.4| (fp.sub RNE |block.4| bias_1))
  (= |block'.5| (fp.sub RNE |block.5| bias_2))
  (= |block'.6| (fp.sub RNE |block.6| bias_0))
  (= |block'.7| (fp.sub RNE |block.7| bias_1))
  (= |block'.8| (fp.sub RNE |block.8| bias_2))
  (= |block'.9| (fp.sub RNE |block.9| bias_0))
  (= |block'.10| (fp.sub RNE |block.10| bias_1))
  (= |block'.11| (fp.sub RNE |block.11| bias_2))
  (= |block'.12| (fp.sub RNE |block.12| bias_0))
  (= |block'.13| (fp.sub RNE |block.13| bias_1))
  (= |block'.14| (fp.sub RNE |block.14| bias_2))
  (= |block'.15| (fp.sub RNE |block.15| bias_0))
  (= |block'.16| (fp.sub RNE |block.16| bias_1))
  (= |block'.17| (fp.sub RNE |block.17| bias_2))
  (= |block'.18| (fp.sub RNE |block.18| bias_0))
  (= |block'.19| (fp.sub RNE |block.19| bias_1))
  (= |block'.20| (fp.sub RNE |block.20| bias_2))
  (= |block'.21| (fp.sub RNE |block.21| bias_0))
  (= |block'.22| (fp.sub RNE |block.22| bias_1))
  (= |block'.23| (fp.sub RNE |block.23| bias_2)))

;@ claim middle: where the ramp does not end within the block, its steps are the mean of those of the single samples
(=> (bvsge (left valid) (_ bv16 32))
  (= (bvmul (_ bv8 36) (long middle))
     (bvadd
       (bvsub (long (left valid)) (_ bv2 36)) (bvsub (long (left valid)) (_ bv4 36))
       (bvsub (long (left valid)) (_ bv6 36)) (bvsub (long (left valid)) (_ bv8 36))
       (bvsub (long (left valid)) (_ bv10 36)) (bvsub (long (left valid)) (_ bv12 36))
       (bvsub (long (left valid)) (_ bv14 36)) (bvsub (long (left valid)) (_ bv16 36)))))
