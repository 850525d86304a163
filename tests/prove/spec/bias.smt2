; Terms::bias.
;@ function prove_bias

;@ define
(define-fun most () F32 ((_ to_fp 8 24) RNE 100000000000000000000.0))

;@ assume terms: coefficients that Table::new accepts
(and
  (within |terms.a0| (fp.neg most) most)
  (within |terms.a1| (fp.neg most) most)
  (within |terms.a2| (fp.neg most) most)
  (within |terms.r0| (fp.neg most) most)
  (within |terms.r1| (fp.neg most) most)
  (within |terms.s0| (fp.neg most) most)
  (within |terms.s1| (fp.neg most) most))

;@ assume place: what Table::place yields (proved)
(and (within |z| zero ((_ to_fp 8 24) RNE 1.0)) (fp.lt |z| ((_ to_fp 8 24) RNE 1.0)))

;@ assume rate: what ThermalState::update yields (proved)
(within |rate_c_per_min| (fp.neg ((_ to_fp 8 24) RNE 10000.0)) ((_ to_fp 8 24) RNE 10000.0))

;@ assume lag: what ThermalState::update yields
(within |lag2_c| (fp.neg ((_ to_fp 8 24) RNE 1000.0)) ((_ to_fp 8 24) RNE 1000.0))

;@ claim finite: the bias is finite
(finite |result|)

;@ claim equation: the bias is the documented polynomial, in this order
(= |result|
  (fp.add RNE
    (fp.add RNE
      (fp.add RNE |terms.a0| (fp.mul RNE |z| (fp.add RNE |terms.a1| (fp.mul RNE |z| |terms.a2|))))
      (fp.mul RNE |rate_c_per_min| (fp.add RNE |terms.r0| (fp.mul RNE |z| |terms.r1|))))
    (fp.mul RNE |lag2_c| (fp.add RNE |terms.s0| (fp.mul RNE |z| |terms.s1|)))))
