//! Copies for processors without a C library, in 100 bytes. The compiler's run-time library has
//! faster ones, which take 1 KB; but only set-up functions copy objects.
//!
//! The names are those of Arm's run-time ABI. An archive hides them.

/// Volatile, or the compiler makes a call of the very function of it.
///
/// # Safety
/// As of [`core::ptr::copy_nonoverlapping`].
#[inline(always)]
unsafe fn copy<T>(to: *mut T, from: *const T, count: usize) {
    for at in 0..count {
        // SAFETY: the caller vouches for so many.
        unsafe { to.add(at).write_volatile(from.add(at).read_volatile()) };
    }
}

/// Copies bytes.
///
/// # Safety
/// As of `memcpy`.
#[unsafe(export_name = "__aeabi_memcpy")]
unsafe extern "C" fn memcpy(to: *mut u8, from: *const u8, bytes: usize) {
    // SAFETY: the caller vouches for it.
    unsafe { copy(to, from, bytes) };
}

/// Copies words and what is left.
///
/// # Safety
/// As of `memcpy`, of pointers to words.
#[unsafe(export_name = "__aeabi_memcpy4")]
unsafe extern "C" fn memcpy4(to: *mut u32, from: *const u32, bytes: usize) {
    let (words, left) = (bytes / 4, bytes % 4);
    // SAFETY: the caller vouches for it.
    unsafe {
        copy(to, from, words);
        memcpy(to.add(words).cast(), from.add(words).cast(), left);
    }
}

/// As [`memcpy4`], of pointers to eight bytes.
///
/// # Safety
/// As of `memcpy4`.
#[unsafe(export_name = "__aeabi_memcpy8")]
unsafe extern "C" fn memcpy8(to: *mut u32, from: *const u32, bytes: usize) {
    // SAFETY: the caller vouches for it.
    unsafe { memcpy4(to, from, bytes) };
}

/// Makes zeros of words, and of what is left.
///
/// # Safety
/// As of `memset`, of a pointer to words.
#[unsafe(export_name = "__aeabi_memclr4")]
unsafe extern "C" fn memclr4(to: *mut u32, bytes: usize) {
    let (words, left) = (bytes / 4, bytes % 4);
    for at in 0..words {
        // SAFETY: the caller vouches for so many.
        unsafe { to.add(at).write_volatile(0) };
    }
    for at in 0..left {
        // SAFETY: likewise.
        unsafe { to.add(words).cast::<u8>().add(at).write_volatile(0) };
    }
}
