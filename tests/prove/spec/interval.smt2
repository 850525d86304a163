; Interval::new, for the settings of any table.
;@ function prove_interval

;@ define
(define-fun half_tau () F32 (fp.mul RNE |thermal.settings.tau_s| ((_ to_fp 8 24) RNE 0.5)))
(define-fun forward () Bool (fp.gt |dt_s| zero))
; Not `unordered or at most`, as the compiler has it: the solvers then share the products.
(define-fun gap () Bool
  (not (or (or (fp.isNaN |dt_s|) (fp.isNaN half_tau)) (fp.leq |dt_s| half_tau))))
(define-fun real_s () F32 (ite forward |dt_s| zero))
(define-fun one () F32 ((_ to_fp 8 24) RNE 1.0))

;@ assume settings: what Thermal::new accepts and derives
(and
  (within |thermal.settings.tau_s| ((_ to_fp 8 24) RNE 0.1) ((_ to_fp 8 24) RNE 6000.0))
  (= |thermal.per_tau_hz| (fp.div RNE one |thermal.settings.tau_s|))
  (within |thermal.per_tau2_hz| ((_ to_fp 8 24) RNE 0.00001666) ((_ to_fp 8 24) RNE 10.0))
  (within |thermal.settings.spike_gate_c| ((_ to_fp 8 24) RNE 0.001) ((_ to_fp 8 24) RNE 1000.0))
  (within |thermal.settings.max_slew_c_per_min| ((_ to_fp 8 24) RNE 0.001) ((_ to_fp 8 24) RNE 10000.0)))

;@ claim gate: the spike gate if time has passed, else negative infinity, within which nothing lies
(= |interval'.gate_c| (ite forward |thermal.settings.spike_gate_c| (_ -oo 8 24)))

;@ claim near: the bits of the gate and the slew together
(= ((_ to_fp 8 24) |interval'.near|)
   (fp.add RNE |interval'.gate_c| ((_ to_fp 8 24) |interval'.slew|)))

;@ claim flag_interval: INTERVAL_INVALID if and only if no time or more than half the time constant has passed, and no other flag
(= |interval'.status| (ite (or gap (not forward)) (_ bv16 16) (_ bv0 16)))

;@ claim ticks: never negative, and none without time
(and (bvsle (_ bv0 32) |interval'.ticks|)
     (=> (not forward) (= |interval'.ticks| (_ bv0 32))))

;@ claim ticks_equation: the time in ticks of 10 us, rounded, and at the end of its range held there
(let ((scaled (fp.add RNE (fp.mul RNE real_s ((_ to_fp 8 24) RNE 100000.0))
                          ((_ to_fp 8 24) RNE 0.5)))
      (most ((_ to_fp 8 24) RNE 2147483648.0)))
  (= |interval'.ticks|
    (ite (fp.geq scaled most) (_ bv2147483647 32) ((_ fp.to_sbv 32) RTZ scaled))))

;@ claim slew_equation: the slew of that time, but for at most half the time constant and at least 2e-5 degC
(let ((slew (fp.mul RNE
        (fp.mul RNE |thermal.settings.max_slew_c_per_min| (ite (not gap) real_s half_tau))
        (fp.div RNE ((_ to_fp 8 24) RNE 1.0) ((_ to_fp 8 24) RNE 60.0))))
      (least ((_ to_fp 8 24) RNE 0.00002)))
  (= ((_ to_fp 8 24) |interval'.slew|) (ite (and forward (fp.lt slew least)) least slew)))

;@ claim gap: after a gap the estimator begins again and gives no rate
(=> gap (and (fp.eq |interval'.alpha| one) (fp.eq |interval'.rate_gain_per_min| zero)))

;@ claim factors abstract: without a gap, the share of the filter and the gain of the rate follow the documented series
(let ((x (fp.mul RNE |thermal.per_tau_hz| real_s)))
(let ((half (fp.mul RNE x ((_ to_fp 8 24) RNE 0.5)))
      (third (fp.mul RNE x (fp.div RNE one ((_ to_fp 8 24) RNE 3.0))))
      (quarter (fp.mul RNE x ((_ to_fp 8 24) RNE 0.25)))
      (fifth (fp.mul RNE x ((_ to_fp 8 24) RNE 0.2))))
(let ((share (fp.sub RNE one (fp.mul RNE half (fp.sub RNE one
               (fp.mul RNE third (fp.sub RNE one (fp.mul RNE quarter (fp.sub RNE one fifth)))))))))
  (=> (not gap) (and
    (= |interval'.alpha| (fp.mul RNE x share))
    (= |interval'.rate_gain_per_min|
       (fp.mul RNE (fp.mul RNE |thermal.per_tau_hz| ((_ to_fp 8 24) RNE 60.0)) share)))))))

;@ claim second_factor abstract: the share of the second lag follows its documented series, and is 1 beyond half its time constant
(let ((x (fp.mul RNE real_s |thermal.per_tau2_hz|)))
(let ((half (fp.mul RNE x ((_ to_fp 8 24) RNE 0.5)))
      (third (fp.mul RNE x (fp.div RNE one ((_ to_fp 8 24) RNE 3.0)))))
  (= |interval'.alpha2|
    (ite (fp.gt x ((_ to_fp 8 24) RNE 0.5)) one
      (fp.mul RNE x (fp.sub RNE one (fp.mul RNE half (fp.sub RNE one third))))))))

;@ claim fade: the weight may move by the time, in parts of 60 s; never negative
(and
  (bvsle (_ bv0 32) |interval'.fade|)
  (= ((_ to_fp 8 24) |interval'.fade|)
     (fp.mul RNE real_s (fp.div RNE one ((_ to_fp 8 24) RNE 60.0)))))

;@ claim slew: from 0 to a finite number, and not below 2e-5 degC if time has passed
(and (bvsle (_ bv0 32) |interval'.slew|)
     (within ((_ to_fp 8 24) |interval'.slew|) zero ((_ to_fp 8 24) RNE 500001.0))
     (=> forward (fp.geq ((_ to_fp 8 24) |interval'.slew|) ((_ to_fp 8 24) RNE 0.00002))))

;@ claim alpha: within 0 to 1
(within |interval'.alpha| zero one)

;@ claim alpha2: the share of the second lag is within 0 to 1
(within |interval'.alpha2| zero one)

;@ claim gain: within 0 to 601 per minute
(within |interval'.rate_gain_per_min| zero ((_ to_fp 8 24) RNE 601.0))
