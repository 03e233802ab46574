//! Errors of the search for capsules.

/// The reason for which a picture gives no contour.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The bytes are no picture of a known format.
    #[error("it cannot be read as PNG, JPEG or TIFF: {reason}")]
    Unreadable {
        /// Message of the decoder.
        reason: String,
    },
    /// Too few pixels for a capsule.
    #[error("the picture has {width} x {height} pixels: at least {least} are needed on each side")]
    TooSmall {
        /// Its width.
        width: u32,
        /// Its height.
        height: u32,
        /// The fewest.
        least: u32,
    },
    /// The background is another picture.
    #[error(
        "the picture has {} x {} pixels and its background {} x {}: they must be of one camera and cropped alike",
        picture[0], picture[1], background[0], background[1]
    )]
    Sizes {
        /// Width and height of the picture.
        picture: [u32; 2],
        /// Those of the background.
        background: [u32; 2],
    },
    /// The background has another kind of grey levels.
    #[error(
        "one of picture and background has floating-point grey levels, the other whole numbers, so their scales \
         differ: save both in one way"
    )]
    Levels,
    /// Nothing stands out.
    #[error(
        "no capsule is seen: nothing of at least {least} pixels across stands out from the background; a picture of \
         the empty channel as background may help"
    )]
    NoCapsule {
        /// The least extent of a capsule.
        least: u32,
    },
    /// Every capsule is cut by the border.
    #[error("the capsule touches the border of the picture: the whole outline must be seen")]
    TouchesBorder,
    /// Something is at one end of the channel.
    #[error(
        "the two ends of the channel look different, as if a capsule touched the border of the picture there: crop the \
         picture to one whole capsule and empty channel on both sides of it, or give the empty channel as background"
    )]
    EndsDiffer,
}
