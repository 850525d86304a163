; ThermalState::update, the conditioner and the rate estimator included.
;@ function prove_update

;@ define
; The constants as they are in f32.
(define-fun c_low () F32 (fp.neg ((_ to_fp 8 24) RNE 273.15)))
(define-fun c_1e3 () F32 ((_ to_fp 8 24) RNE 1000.0))
(define-fun c_1e4 () F32 ((_ to_fp 8 24) RNE 10000.0))
(define-fun c_milli () F32 ((_ to_fp 8 24) RNE 0.001))
(define-fun filter_bound () F32 ((_ to_fp 8 24) RNE 137438953472.0))
(define-fun remainder_bound () F32 ((_ to_fp 8 24) RNE 8192.0))
(define-fun effective_bound () F32 ((_ to_fp 8 24) RNE 2097152.0))
(define-fun one () F32 ((_ to_fp 8 24) RNE 1.0))
(define-fun memory_bound () F32 ((_ to_fp 8 24) RNE 67108864.0))
(define-fun memory_rest () F32 ((_ to_fp 8 24) RNE 4.0))
(define-fun gain_most () F32 ((_ to_fp 8 24) RNE 128.0))
(define-fun temp_bound () F32 ((_ to_fp 8 24) RNE 2048.0))
; Magnitudes that are kept as bits.
(define-fun reach_c () F32 ((_ to_fp 8 24) |thermal.sensor_reach|))
(define-fun slew_c () F32 ((_ to_fp 8 24) |interval.slew|))
(define-fun near_c () F32 ((_ to_fp 8 24) |interval.near|))
(define-fun forward () Bool (not (fp.isInfinite |interval.gate_c|)))

;@ assume settings: what Thermal::new accepts and derives
(and
  (within |thermal.sensor_middle_c| c_low c_1e3)
  (within reach_c zero ((_ to_fp 8 24) RNE 640.0))
  (bvsle (_ bv0 32) |thermal.sensor_reach|)
  (within |thermal.settings.spike_gate_c| c_milli c_1e3)
  (within |thermal.settings.rate_min_c_per_min| (fp.neg c_1e4) zero)
  (within |thermal.settings.rate_max_c_per_min| zero c_1e4)
  (within |thermal.settings.reference_c| c_low c_1e3)
  (within |thermal.slew_c_per_tick| zero ((_ to_fp 8 24) RNE 0.001667))
  (within |thermal.least_memory| ((_ to_fp 8 24) RNE 0.00999) one)
  (within |thermal.shift_min| zero ((_ to_fp 8 24) RNE 200.0))
  (ticks_within |thermal.hold_ticks| (_ bv0 32) (_ bv2000000000 32))
  (ticks_within |thermal.healing| (bvneg (_ bv2000000000 32)) (_ bv0 32))
  (ticks_within |thermal.settling| (bvneg (_ bv2000000000 32)) (bvneg (_ bv1 32)))
  (ticks_within |thermal.restart_ticks| (_ bv1 32) (_ bv2000000000 32)))

;@ assume interval: what Interval::new makes (proved below)
(and
  (bvsle (_ bv0 32) |interval.ticks|)
  (within |interval.alpha| zero ((_ to_fp 8 24) RNE 1.0))
  (within |interval.rate_gain_per_min| zero ((_ to_fp 8 24) RNE 601.0))
  (bvsle (_ bv0 32) |interval.slew|)
  (within slew_c zero ((_ to_fp 8 24) RNE 500001.0))
  (or (= |interval.gate_c| |thermal.settings.spike_gate_c|) (= |interval.gate_c| (_ -oo 8 24)))
  (= near_c (fp.add RNE |interval.gate_c| slew_c))
  (= (bvand |interval.status| (bvnot (_ bv16 16))) (_ bv0 16)))

;@ define
(define-fun memory_invariant ((value F32) (remainder F32)) Bool
  (and (within value (fp.neg memory_bound) memory_bound)
       (within remainder (fp.neg memory_rest) memory_rest)))
(define-fun invariant ((temp F32) (age (_ BitVec 32)) (filtered F32) (remainder F32)
                       (effective F32)) Bool
  (and
    (within temp (fp.neg temp_bound) temp_bound)
    (bvsle (_ bv0 32) age)
    (within filtered (fp.neg filter_bound) filter_bound)
    (within remainder (fp.neg remainder_bound) remainder_bound)
    (within effective (fp.neg effective_bound) effective_bound)))

;@ assume state: the invariant, which ThermalState::new establishes
(invariant |state.conditioner.temp_c| |state.conditioner.age| |state.estimator.filtered.value| |state.estimator.filtered.remainder|
           |state.effective_c|)

;@ assume memory: the invariant of the estimator's memory, which RateEstimator::new establishes
(memory_invariant |state.estimator.memory.value| |state.estimator.memory.remainder|)

;@ assume gain: that of its gain
(within |state.estimator.gain| one gain_most)

;@ define
; What the documentation says, in its own words.
(define-fun in_range () Bool
  (fp.leq (fp.abs (fp.sub RNE |temp_c| |thermal.sensor_middle_c|)) reach_c))
(define-fun spec_age () (_ BitVec 32)
  (sum |state.conditioner.age| |interval.ticks|))
(define-fun was_lost () Bool (bvsgt |state.conditioner.age| |thermal.hold_ticks|))
(define-fun far_c () F32
  (fp.add RNE |interval.gate_c|
    (fp.mul RNE |thermal.slew_c_per_tick| ((_ to_fp 8 24) RNE spec_age))))
(define-fun change_c () F32 (fp.sub RNE |temp_c| |state.conditioner.temp_c|))
(define-fun plausible () Bool (fp.leq (fp.abs change_c) (ite was_lost near_c far_c)))
(define-fun accepted () Bool (and in_range plausible))
(define-fun fresh () Bool
  (or (fp.gt (fp.abs change_c) near_c) (bvsgt spec_age |thermal.restart_ticks|)))
(define-fun restart () Bool (and accepted fresh))
(define-fun lost () Bool (bvsgt |state'.conditioner.age| |thermal.hold_ticks|))
; A reading that is not accepted is gone on with only once the temperature is lost.
(define-fun taken () Bool (and in_range (or plausible lost)))
(define-fun filtered () F32
  (ite (and taken fresh) (fp.add RNE change_c |state.estimator.filtered.value|) |state.estimator.filtered.value|))
(define-fun lag_c () F32
  (fp.sub RNE (fp.sub RNE |state'.conditioner.temp_c| filtered) |state.estimator.filtered.remainder|))
(define-fun memory_lag () F32
  (fp.sub RNE (fp.sub RNE one |state.estimator.memory.value|)
    |state.estimator.memory.remainder|))
(define-fun shared () F32
  (ite (fp.gt |state'.estimator.memory.value| |thermal.least_memory|)
    |state'.estimator.memory.value| |thermal.least_memory|))
; One step of Newton's method for its reciprocal.
(define-fun newton () F32
  (fp.mul RNE |state.estimator.gain|
    (fp.sub RNE ((_ to_fp 8 24) RNE 2.0) (fp.mul RNE shared |state.estimator.gain|))))
(define-fun spec_rate () F32
  (fp.mul RNE (fp.mul RNE lag_c |interval.rate_gain_per_min|) |state'.estimator.gain|))
(define-fun spec_target () F32
  (ite lost |thermal.settings.reference_c|
    (fp.sub RNE |state'.conditioner.temp_c| (fp.mul RNE |thermal.shift_min| |rate_c_per_min'.value|))))
(define-fun way_c () F32 (fp.sub RNE spec_target |state.effective_c|))
(define-fun spec_step () F32
  (ite (fp.gt way_c slew_c) slew_c
  (ite (fp.lt way_c (fp.neg slew_c)) (fp.neg slew_c) way_c)))

;@ claim far: the gate in effect is a number and positive, or nothing passes without time
(ite forward (fp.leq c_milli far_c) (= far_c (_ -oo 8 24)))

;@ claim near: so is the gate between two readings
(ite forward (fp.leq c_milli near_c) (= near_c (_ -oo 8 24)))

;@ claim change: the change of a temperature in range is a number
(=> in_range (finite change_c))

;@ claim belief abstract by far,near,change: the temperature is taken if accepted or to be confirmed, else it is what it was, NaN and infinite included
(= |state'.conditioner.temp_c| (ite taken |temp_c| |state.conditioner.temp_c|))

;@ claim age abstract by far,near,change: ticks since the last accepted temperature
(= |state'.conditioner.age| (ite accepted (_ bv0 32) spec_age))

;@ claim settling abstract by far,near,change: begins at a restart, is extended by rejections and else runs down
(let ((healing (difference |thermal.healing| |state.conditioner.age|)))
  (= |state'.conditioner.settled|
    (ite restart |thermal.settling|
    (ite accepted (sum |state.conditioner.settled| |interval.ticks|)
    (ite (bvslt |state.conditioner.settled| healing) |state.conditioner.settled| healing)))))

;@ claim counters abstract by far,near,change: rejections and restarts are counted, each by one
(and
  (= |state'.conditioner.rejected| (bvadd |state.conditioner.rejected| (ite accepted (_ bv0 32) (_ bv1 32))))
  (= |state'.conditioner.restarts| (bvadd |state.conditioner.restarts| (ite restart (_ bv1 32) (_ bv0 32)))))

;@ claim flag_invalid abstract by far,near,change: TEMPERATURE_INVALID if and only if NaN or out of the sensor's range
(= (flag |status'.value| (_ bv1 16)) (not in_range))

;@ claim flag_spike abstract by far,near,change: TEMPERATURE_SPIKE if and only if in range and not plausible, though time has passed
(= (flag |status'.value| (_ bv2 16)) (and in_range (not plausible) forward))

;@ claim flag_lost: TEMPERATURE_LOST if and only if the age exceeds the hold time
(= (flag |status'.value| (_ bv4 16)) lost)

;@ claim flag_interval: INTERVAL_INVALID follows the interval, and no other flag is ever set
(= (bvand |status'.value| (bvnot (_ bv79 16))) |interval.status|)

;@ claim memory_equation abstract: the share of the memory follows the equations of the filter, for a step to 1
(let ((increment (fp.add RNE |state.estimator.memory.remainder|
                             (fp.mul RNE |interval.alpha| memory_lag))))
  (and
    (same |state'.estimator.memory.value| (fp.add RNE |state.estimator.memory.value| increment))
    (same |state'.estimator.memory.remainder|
      (fp.sub RNE increment
        (fp.sub RNE |state'.estimator.memory.value| |state.estimator.memory.value|)))))

;@ claim gain_equation abstract: a step of Newton's method, and at least 1
(= |state'.estimator.gain| (ite (fp.gt newton one) newton one))

;@ claim no_correction: with a time constant of 60 s or less, a gain of 1 stays
(=> (and (= |thermal.least_memory| one) (= |state.estimator.gain| one))
    (= |state'.estimator.gain| one))

;@ claim kept_gain slow by gain_equation: the invariant of the gain is kept
(within |state'.estimator.gain| one gain_most)

;@ claim rate by kept_gain: the rate is a number before it is limited
(finite spec_rate)

;@ claim flag_clamped abstract by far,near,change,rate: RATE_CLAMPED if and only if the rate left its range; the rate given is the nearest in range
(and
  (= (flag |status'.value| (_ bv64 16))
     (or (fp.lt spec_rate |thermal.settings.rate_min_c_per_min|)
         (fp.gt spec_rate |thermal.settings.rate_max_c_per_min|)))
  (same |rate_c_per_min'.value|
    (ite (fp.lt spec_rate |thermal.settings.rate_min_c_per_min|) |thermal.settings.rate_min_c_per_min|
    (ite (fp.gt spec_rate |thermal.settings.rate_max_c_per_min|) |thermal.settings.rate_max_c_per_min|
      spec_rate))))

;@ claim way: the way to the target is a number
(finite way_c)

;@ claim flag_settling abstract by near,way: SETTLING if and only if settling or further from the target than the gate and the slew
(= (flag |status'.value| (_ bv8 16))
   (or (bvslt |state'.conditioner.settled| (_ bv0 32))
       (not (fp.leq (fp.abs way_c) near_c))))

;@ claim filter_equation abstract by far,near,change: the filtered temperature and its remainder follow the documented equations
(let ((increment (fp.add RNE |state.estimator.filtered.remainder| (fp.mul RNE |interval.alpha| lag_c))))
  (and
    (same |state'.estimator.filtered.value| (fp.add RNE filtered increment))
    (same |state'.estimator.filtered.remainder|
      (fp.sub RNE increment (fp.sub RNE |state'.estimator.filtered.value| filtered)))))

;@ claim slew abstract by way: the lag-compensated temperature moves towards its target by a step of the slew at most, rounded once
(and
  (within spec_step (fp.neg slew_c) slew_c)
  (=> (fp.leq (fp.abs way_c) slew_c) (= spec_step way_c))
  (same |state'.effective_c| (fp.add RNE |state.effective_c| spec_step)))

;@ claim output: the lag-compensated temperature given is the one kept, and the rate is in its range
(and
  (same |effective_c'.value| |state'.effective_c|)
  (within |rate_c_per_min'.value| |thermal.settings.rate_min_c_per_min| |thermal.settings.rate_max_c_per_min|))

;@ claim finite: every output and every part of the state is finite
(and (finite |effective_c'.value|) (finite |rate_c_per_min'.value|) (finite |state'.conditioner.temp_c|)
     (finite |state'.estimator.filtered.value|) (finite |state'.estimator.filtered.remainder|)
     (finite |state'.estimator.memory.value|) (finite |state'.estimator.memory.remainder|)
     (finite |state'.estimator.gain|) (finite |state'.effective_c|))

;@ claim kept: the invariant of temperature and times is kept
(and (within |state'.conditioner.temp_c| (fp.neg temp_bound) temp_bound)
     (bvsle (_ bv0 32) |state'.conditioner.age|))

;@ claim kept_effective: the invariant of the lag-compensated temperature is kept
(within |state'.effective_c| (fp.neg effective_bound) effective_bound)

;@ claim kept_filtered: the invariant of the filtered temperature is kept
(within |state'.estimator.filtered.value| (fp.neg filter_bound) filter_bound)

;@ claim kept_memory: the invariant of the memory is kept
(within |state'.estimator.memory.value| (fp.neg memory_bound) memory_bound)

;@ claim kept_memory_rest slow: the invariant of what rounding left out of the memory is kept
(within |state'.estimator.memory.remainder| (fp.neg memory_rest) memory_rest)

;@ claim kept_remainder slow: the invariant of the remainder is kept
(within |state'.estimator.filtered.remainder| (fp.neg remainder_bound) remainder_bound)
