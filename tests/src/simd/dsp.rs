//! The instructions, a few at a time.
#![expect(unsafe_code, reason = "instructions that the language has no other name for")]

use core::arch::asm;

/// A function of registers by instructions that touch nothing but them and the flags.
macro_rules! registers {
    ($($(#[$doc:meta])* fn $name:ident($($arg:ident),+; $($given:ident = $value:expr),*) { $($line:literal)+ })+) => {
        $($(#[$doc])*
        #[inline(always)]
        pub fn $name($($arg: u32),+) -> u32 {
            let out: u32;
            // SAFETY: instructions of the extension that `cfg(dsp)` tells of; they read and write registers and flags only.
            unsafe {
                asm!(
                    $($line,)+
                    $($arg = in(reg) $arg,)+
                    $($given = in(reg) $value,)*
                    out = out(reg) out,
                    options(pure, nomem, nostack)
                );
            }
            out
        })+
    };
}

registers! {
    /// All bits of each byte that is not less than that of `b`.
    fn at_least(a, b; all = u32::MAX, none = 0_u32) { "usub8 {out}, {a}, {b}" "sel {out}, {all}, {none}" }

    /// The greater one of each pair of signed halves.
    fn max_halves(a, b;) { "ssub16 {out}, {a}, {b}" "sel {out}, {a}, {b}" }

    /// The lesser one of each pair of signed halves.
    fn min_halves(a, b;) { "ssub16 {out}, {a}, {b}" "sel {out}, {b}, {a}" }

    /// The lesser one of each pair of unsigned halves.
    fn min_unsigned_halves(a, b;) { "usub16 {out}, {a}, {b}" "sel {out}, {b}, {a}" }

    /// All bits of each unsigned half that is not greater than that of `b`.
    fn at_most_halves(a, b; all = u32::MAX, none = 0_u32) { "usub16 {out}, {b}, {a}" "sel {out}, {all}, {none}" }
}

/// Puts into `signs` whether the neighbours at an address are less than the centres.
macro_rules! sign {
    ($place:literal) => {
        concat!(
            "ldr {n}, ",
            $place,
            "\n",
            "usub8 {n}, {n}, {c}\n",
            "sel {n}, {none}, {one}\n",
            "orr {signs}, {n}, {signs}, lsl #1\n",
        )
    };
}

/// Signs of the eight pixels around each: `rows` are those two above to two below, which begin two pixels further left than
/// `out`, whose length is a multiple of 4.
#[inline(always)]
pub fn census_words(rows: [&[u8]; 5], out: &mut [u8]) {
    assert!(!out.is_empty() && out.len().is_multiple_of(4) && rows.iter().all(|row| row.len() >= out.len() + 4));
    // SAFETY: it reads the first `out.len() + 4` bytes of the rows at most and writes `out.len()` bytes of `out`.
    unsafe {
        asm!(
            // A row's pointer is that of its last neighbour, and goes on with it.
            "2:",
            "ldr {c}, [{r2}, #-2]",
            "ldr {n}, [{r0}], #4",
            "usub8 {n}, {n}, {c}",
            "sel {signs}, {none}, {one}",
            sign!("[{r1}, #-2]"),
            sign!("[{r1}], #4"),
            sign!("[{r2}, #-4]"),
            sign!("[{r2}], #4"),
            sign!("[{r3}, #-2]"),
            sign!("[{r3}], #4"),
            sign!("[{r4}], #4"),
            "str {signs}, [{out}], #4",
            "cmp {out}, {end}",
            "bne 2b",
            r0 = inout(reg) rows[0].as_ptr().add(2) => _,
            r1 = inout(reg) rows[1].as_ptr().add(3) => _,
            r2 = inout(reg) rows[2].as_ptr().add(4) => _,
            r3 = inout(reg) rows[3].as_ptr().add(3) => _,
            r4 = inout(reg) rows[4].as_ptr().add(2) => _,
            out = inout(reg) out.as_mut_ptr() => _,
            end = in(reg) out.as_ptr_range().end,
            c = out(reg) _,
            n = out(reg) _,
            signs = out(reg) _,
            one = in(reg) 0x0101_0101_u32,
            none = in(reg) 0_u32,
            options(nostack)
        );
    }
}

/// Horizontal Sobel responses, with `cap` added and clipped to `0..=2 * cap`, of the columns from the second on: `rows` are
/// that above, the row itself and that below, `out` has a length that is a multiple of 4.
#[inline(always)]
pub fn sobel_words(rows: [&[u8]; 3], cap: u8, out: &mut [u8]) {
    assert!(!out.is_empty() && out.len().is_multiple_of(4) && rows.iter().all(|row| row.len() >= out.len() + 2));
    let both = |value: u8| u32::from(value) * 0x1_0001;
    // SAFETY: it reads the first `out.len() + 2` bytes of the rows and writes `out.len()` bytes of `out`.
    unsafe {
        asm!(
            // Of four columns the first and the third in `e`, the second and the fourth in `o`: first the right
            // neighbours with the cap, then the left ones.
            "2:",
            "ldr {t}, [{above}, #2]",
            "uxtab16 {e}, {cap}, {t}",
            "uxtab16 {o}, {cap}, {t}, ror #8",
            "ldr {t}, [{below}, #2]",
            "uxtab16 {e}, {e}, {t}",
            "uxtab16 {o}, {o}, {t}, ror #8",
            "ldr {t}, [{row}, #2]",
            "uxtab16 {e}, {e}, {t}",
            "uxtab16 {e}, {e}, {t}",
            "uxtab16 {o}, {o}, {t}, ror #8",
            "uxtab16 {o}, {o}, {t}, ror #8",
            "ldr {t}, [{above}], #4",
            "uxtb16 {f}, {t}",
            "uxtb16 {p}, {t}, ror #8",
            "ldr {t}, [{below}], #4",
            "uxtab16 {f}, {f}, {t}",
            "uxtab16 {p}, {p}, {t}, ror #8",
            "ldr {t}, [{row}], #4",
            "uxtab16 {f}, {f}, {t}",
            "uxtab16 {f}, {f}, {t}",
            "uxtab16 {p}, {p}, {t}, ror #8",
            "uxtab16 {p}, {p}, {t}, ror #8",
            "uqsub16 {e}, {e}, {f}",
            "uqsub16 {o}, {o}, {p}",
            "usub16 {f}, {most}, {e}",
            "sel {e}, {e}, {most}",
            "usub16 {f}, {most}, {o}",
            "sel {o}, {o}, {most}",
            "orr {e}, {e}, {o}, lsl #8",
            "str {e}, [{out}], #4",
            "cmp {out}, {end}",
            "bne 2b",
            above = inout(reg) rows[0].as_ptr() => _,
            row = inout(reg) rows[1].as_ptr() => _,
            below = inout(reg) rows[2].as_ptr() => _,
            out = inout(reg) out.as_mut_ptr() => _,
            end = in(reg) out.as_ptr_range().end,
            cap = in(reg) both(cap),
            most = in(reg) both(2 * cap),
            t = out(reg) _,
            e = out(reg) _,
            o = out(reg) _,
            f = out(reg) _,
            p = out(reg) _,
            options(nostack)
        );
    }
}
