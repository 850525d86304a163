; What the specifications share. Loaded before the code of a function.
(set-logic QF_BVFP)
(define-sort F32 () (_ FloatingPoint 8 24))
(define-fun zero () F32 ((_ to_fp 8 24) RNE 0.0))
(define-fun infinity () F32 (_ +oo 8 24))
(define-fun finite ((x F32)) Bool (not (or (fp.isNaN x) (fp.isInfinite x))))
(define-fun within ((x F32) (low F32) (high F32)) Bool (and (fp.leq low x) (fp.leq x high)))
; Either sign of zero is the same number; NaN is itself.
(define-fun same ((x F32) (y F32)) Bool (or (fp.eq x y) (and (fp.isNaN x) (fp.isNaN y))))
(define-fun ticks_within ((x (_ BitVec 32)) (low (_ BitVec 32)) (high (_ BitVec 32))) Bool
  (and (bvsle low x) (bvsle x high)))
(define-fun saturating ((wide (_ BitVec 34)) (narrow (_ BitVec 32))) (_ BitVec 32)
  (ite (bvsgt wide (_ bv2147483647 34)) (_ bv2147483647 32)
  (ite (bvslt wide (_ bv15032385536 34)) (_ bv2147483648 32) narrow)))
(define-fun sum ((x (_ BitVec 32)) (y (_ BitVec 32))) (_ BitVec 32)
  (saturating (bvadd ((_ sign_extend 2) x) ((_ sign_extend 2) y)) (bvadd x y)))
(define-fun difference ((x (_ BitVec 32)) (y (_ BitVec 32))) (_ BitVec 32)
  (saturating (bvsub ((_ sign_extend 2) x) ((_ sign_extend 2) y)) (bvsub x y)))
(define-fun flag ((status (_ BitVec 16)) (bit (_ BitVec 16))) Bool
  (not (= (bvand status bit) (_ bv0 16))))
