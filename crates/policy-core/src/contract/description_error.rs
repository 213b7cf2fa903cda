//! Why something in a world can't be as described.

/// Why the description of something in a world is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DescriptionError {
    /// A number is out of its range, or not a number.
    #[error("expected {field} of {what} between {least} and {most}, found {found}")]
    Range {
        /// `a prop`, `a fixture`, `a joint`, `a character`, `a grab` or `a ray`.
        what: &'static str,
        /// Name of the field.
        field: &'static str,
        /// Least.
        least: f32,
        /// Most.
        most: f32,
        /// Given.
        found: f32,
    },
    /// The corners of a mesh enclose nothing.
    #[error("expected corners of a hull that are not in one plane, found a thickness of {thickness_m} m")]
    Flat {
        /// The least extent, metres.
        thickness_m: f32,
    },
    /// A triangle names a corner that does not exist.
    #[error("expected triangle {triangle} to name corners below {corners}, found {found}")]
    Corner {
        /// Index of the triangle.
        triangle: usize,
        /// Number of corners.
        corners: usize,
        /// Found.
        found: u32,
    },
    /// A triangle has no area.
    #[error("expected triangle {triangle} to have an area of at least {least_m2} m2, found {found_m2}")]
    Sliver {
        /// Index of the triangle.
        triangle: usize,
        /// Least area, square metres.
        least_m2: f32,
        /// Found.
        found_m2: f32,
    },
    /// The height field has another number of heights than of points.
    #[error("expected {expected} heights, found {found}")]
    Heights {
        /// Rows times columns.
        expected: usize,
        /// Given.
        found: usize,
    },
    /// Too many of something.
    #[error("expected at most {most} {what}, found more")]
    TooMany {
        /// What is counted.
        what: &'static str,
        /// Most.
        most: usize,
    },
}

/// Checks a number against its range, least and most.
///
/// # Errors
/// When it is outside, or not a number; the error has the names of `what` and `field`.
pub fn within(
    what: &'static str,
    field: &'static str,
    found: f32,
    [least, most]: [f32; 2],
) -> Result<(), DescriptionError> {
    if (least..=most).contains(&found) {
        Ok(())
    } else {
        Err(DescriptionError::Range { what, field, least, most, found })
    }
}
