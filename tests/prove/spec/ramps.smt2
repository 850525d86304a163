; A buffer of ramps for three axes: two rooms, of which the lowest bit of the sequence number names
; the valid one. Shared by all specifications of the sample half.
;@ define
(define-fun room ((sequence (_ BitVec 32))) (_ BitVec 32) (bvand sequence (_ bv1 32)))
(define-fun valid () (_ BitVec 32) (room |ramps.sequence|))
(define-fun valid_after () (_ BitVec 32) (room |ramps'.sequence|))
(define-fun other () (_ BitVec 32) (room (bvadd |ramps.sequence| (_ bv1 32))))
; The word in a room.
(define-fun word ((place (_ BitVec 32)) (first (_ BitVec 32)) (second (_ BitVec 32))) (_ BitVec 32)
  (ite (= place (_ bv0 32)) first second))
(define-fun number ((place (_ BitVec 32)) (first (_ BitVec 32)) (second (_ BitVec 32))) F32
  ((_ to_fp 8 24) (word place first second)))
; Steps to the end, in either room.
(define-fun left ((place (_ BitVec 32))) (_ BitVec 32) (word place |ramps.left.0| |ramps.left.1|))
(define-fun left_after ((place (_ BitVec 32))) (_ BitVec 32)
  (word place |ramps'.left.0| |ramps'.left.1|))
; Everything else in either room: heads, ends, slopes.
(define-fun line ((place (_ BitVec 32))) (_ BitVec 224) (ite (= place (_ bv0 32))
  (concat |ramps.heads.0| |ramps.ends.0.0| |ramps.ends.1.0| |ramps.ends.2.0|
    |ramps.slopes.0.0| |ramps.slopes.1.0| |ramps.slopes.2.0|)
  (concat |ramps.heads.1| |ramps.ends.0.1| |ramps.ends.1.1| |ramps.ends.2.1|
    |ramps.slopes.0.1| |ramps.slopes.1.1| |ramps.slopes.2.1|)))
(define-fun line_after ((place (_ BitVec 32))) (_ BitVec 224) (ite (= place (_ bv0 32))
  (concat |ramps'.heads.0| |ramps'.ends.0.0| |ramps'.ends.1.0| |ramps'.ends.2.0|
    |ramps'.slopes.0.0| |ramps'.slopes.1.0| |ramps'.slopes.2.0|)
  (concat |ramps'.heads.1| |ramps'.ends.0.1| |ramps'.ends.1.1| |ramps'.ends.2.1|
    |ramps'.slopes.0.1| |ramps'.slopes.1.1| |ramps'.slopes.2.1|)))
; Of the valid room.
(define-fun head () (_ BitVec 32) (word valid |ramps.heads.0| |ramps.heads.1|))
(define-fun samples () (_ BitVec 32) ((_ zero_extend 16) ((_ extract 15 0) head)))
(define-fun flags () (_ BitVec 16) ((_ extract 31 16) head))
; Nothing is written but the steps of the valid room.
(define-fun only_steps () Bool
  (and (= |ramps'.sequence| |ramps.sequence|) (= (left_after other) (left other))
       (= (line_after (_ bv0 32)) (line (_ bv0 32))) (= (line_after (_ bv1 32)) (line (_ bv1 32)))))
(define-fun wide ((x (_ BitVec 32))) (_ BitVec 34) ((_ sign_extend 2) x))
(define-fun not_negative ((x (_ BitVec 32))) (_ BitVec 32) (ite (bvsge x (_ bv0 32)) x (_ bv0 32)))
