; Table::place.
;@ function prove_place

;@ define
(define-fun c_low () F32 (fp.neg ((_ to_fp 8 24) RNE 273.15)))
(define-fun c_1e3 () F32 ((_ to_fp 8 24) RNE 1000.0))
(declare-const count F32)
(define-fun place ((temp F32)) F32
  (fp.mul RNE |table.cells_per_c| (fp.sub RNE temp |table.first_edge_c|)))
; Outside the calibrated range, its nearest end.
(define-fun not_below () F32
  (ite (fp.lt |effective_c| |table.t_min_c|) |table.t_min_c| |effective_c|))
(define-fun clamped () F32
  (ite (fp.gt not_below |table.t_max_c|) |table.t_max_c| not_below))
(define-fun k () F32 ((_ to_fp_unsigned 8 24) RNE |cell'.value|))

;@ assume table: what Table::new accepts and derives: 1 to 1024 cells, the hottest temperature below the count
(and
  (= count (fp.roundToIntegral RTZ count))
  (within count ((_ to_fp 8 24) RNE 1.0) ((_ to_fp 8 24) RNE 1024.0))
  (within |table.first_edge_c| c_low c_1e3)
  (within |table.t_min_c| |table.first_edge_c| c_1e3)
  (within |table.t_max_c| |table.t_min_c| c_1e3)
  (within |table.cells_per_c| ((_ to_fp 8 24) RNE 0.0007) ((_ to_fp 8 24) RNE 1100000.0))
  (fp.lt (place |table.t_max_c|) count))

;@ assume temperature: a number; infinite is allowed
(not (fp.isNaN |effective_c|))

;@ assume monotonic: rounding is monotonic (IEEE 754), said of the two products that are compared
(and
  (=> (fp.leq clamped |table.t_max_c|) (fp.leq (place clamped) (place |table.t_max_c|)))
  (=> (fp.geq clamped |table.first_edge_c|) (fp.geq (place clamped) zero)))

;@ claim index: the cell is one of the table's
(fp.lt k count)

;@ claim cell: the cell is the right one: k <= place < k + 1
(and (fp.leq k (place clamped)) (fp.lt (place clamped) (fp.add RNE k ((_ to_fp 8 24) RNE 1.0))))

;@ claim z: the place within the cell is 0 to below 1, and exact
(and
  (fp.leq zero |z'.value|)
  (fp.lt |z'.value| ((_ to_fp 8 24) RNE 1.0))
  (fp.eq (fp.add RNE k |z'.value|) (place clamped))
  (fp.eq |z'.value| (fp.sub RTN (place clamped) k))
  (fp.eq |z'.value| (fp.sub RTP (place clamped) k)))

;@ claim flag_clamped: TEMPERATURE_CLAMPED if and only if outside the calibrated range, and no other flag
(= |status'.value|
  (ite (or (fp.lt |effective_c| |table.t_min_c|) (fp.gt |effective_c| |table.t_max_c|))
    (_ bv32 16) (_ bv0 16)))
