//! Prints the answer of `capsule-rom identify` as text.

use crate::print;
use anyhow::Result;
use capsule_measurement::{Answer, Ends};

/// Prints the answer as text.
pub fn show(answer: &Answer) -> Result<()> {
    if let Some(contour) = &answer.contour {
        println!("contour: {contour}; flow: {}", answer.flow);
    }
    println!("{}: {}", answer.verdict, answer.verdict_text);
    let row = |name: &str, value: f64, narrow: Ends, wide: Ends, digits: usize| {
        let end = |end: Option<f64>| end.map_or("open".to_owned(), |end| format!("{end:.digits$}"));
        let interval = |[low, high]: Ends| format!("{} to {}", end(low), end(high));
        vec![
            name.to_owned(),
            format!("{value:.digits$}"),
            interval(narrow),
            interval(wide),
        ]
    };
    let milli = |ends: Ends| ends.map(|end| end.map(|end| 1e3 * end));
    print::table(
        &["", "value", "68 %", "95 %"],
        &[
            row("Ca", answer.ca, answer.ca_68, answer.ca_95, 5),
            row(
                "a/l",
                answer.confinement,
                answer.confinement_68,
                answer.confinement_95,
                4,
            ),
            row("a / um", answer.radius_um, answer.radius_um_68, answer.radius_um_95, 3),
            row(
                "G_s / (mN/m)",
                1e3 * answer.gs_n_per_m,
                milli(answer.gs_n_per_m_68),
                milli(answer.gs_n_per_m_95),
                3,
            ),
        ],
    )?;
    if answer.contour.is_some() {
        println!(
            "residuals {:.3} um; edge {:+.3} um, scale {:+.2} %, tilt {:+.2} degrees; chi-squared {:.0} for {:.0}",
            answer.residual_um,
            answer.edge_um,
            100.0 * answer.scale_error,
            answer.tilt_degrees,
            answer.chi_squared,
            answer.degrees_of_freedom
        );
    }
    if let Some(residual) = answer.dent_line_residual_um {
        println!("residuals of the dent line {residual:.3} um");
    }
    if let Some(other) = &answer.alternative {
        println!(
            "another solution: Ca {:.5}, a/l {:.4}, chi-squared greater by {:.2}",
            other.ca, other.confinement, other.rise_of_chi_squared
        );
    }
    println!("against {}, model {}", answer.errors_against, answer.model_digest);
    Ok(())
}
