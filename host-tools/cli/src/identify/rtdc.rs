//! Masks of real-time deformability cytometry: HDF5 files (.rtdc) as Shape-In and dclab write them. Of an event only
//! its mask is read; the size of a pixel, the channel and the flow are options as for any picture.

use anyhow::{Context, Result, bail, ensure};
use capsule_contour::Picture;
use rust_hdf5::{H5Dataset, H5File};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// The first bytes of an HDF5 file.
const SIGNATURE: &[u8; 8] = b"\x89HDF\r\n\x1a\n";
/// The dataset with a mask for each event: events, rows, columns.
const MASKS: &str = "events/mask";

/// Whether a file is HDF5.
pub fn is_one(path: &Path) -> bool {
    let mut first = [0; SIGNATURE.len()];
    File::open(path).is_ok_and(|mut file| file.read_exact(&mut first).is_ok() && first == *SIGNATURE)
}

/// The masks of a file.
pub struct Masks {
    dataset: H5Dataset,
    shape: [usize; 3],
}

impl Masks {
    /// Opens a file.
    pub fn open(path: &Path) -> Result<Self> {
        let file = H5File::open(path).with_context(|| path.display().to_string())?;
        let dataset = file.dataset(MASKS).map_err(|error| {
            let path = path.display();
            anyhow::anyhow!("{path}: an RT-DC file has masks in the dataset {MASKS}, and this has none: {error}")
        })?;
        let Ok(shape) = <[usize; 3]>::try_from(dataset.shape()) else {
            bail!(
                "{}: {MASKS} has the shape {:?}, expected events, rows and columns",
                path.display(),
                dataset.shape()
            );
        };
        Ok(Self { dataset, shape })
    }

    /// How many events there are.
    pub fn count(&self) -> usize {
        self.shape[0]
    }

    /// The mask of an event, from 1.
    pub fn picture(&self, event: Option<usize>) -> Result<Picture> {
        let [count, rows, columns] = self.shape;
        let Some(event) = event else {
            bail!("the file has {count} events: say which by --capsule, or identify all of them by identify batch");
        };
        ensure!(
            (1..=count).contains(&event),
            "--capsule {event}: the file has {count} events, from 1"
        );
        let values: Vec<u8> = self
            .dataset
            .read_numeric_slice_as(&[event - 1, 0, 0], &[1, rows, columns])
            .with_context(|| format!("the mask of event {event}"))?;
        let inside = |x: u32, y: u32| {
            values
                .get(y as usize * columns + x as usize)
                .is_some_and(|value| *value > 0)
        };
        Ok(Picture::mask(columns as u32, rows as u32, inside)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use capsule_contour::Settings;

    #[test]
    fn the_mask_of_an_event_becomes_its_contour() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("events.rtdc");
        let [rows, columns] = [60, 120];
        let radius = |event: usize| [14.0, 20.0][event];
        let file = H5File::create(&path).unwrap();
        let events = file.create_group("events").unwrap();
        let masks = events
            .new_dataset::<u8>()
            .shape([2, rows, columns])
            .create("mask")
            .unwrap();
        let values: Vec<u8> = (0..2 * rows * columns)
            .map(|i| {
                let [x, y] = [i % columns, i / columns % rows].map(|at| at as f64 + 0.5);
                if (x - 60.0).hypot(y - 30.0) < radius(i / (rows * columns)) {
                    255
                } else {
                    0
                }
            })
            .collect();
        masks.write_raw(&values).unwrap();
        file.close().unwrap();
        assert!(is_one(&path));
        let masks = Masks::open(&path).unwrap();
        assert_eq!(masks.count(), 2);
        for event in [0, 1] {
            let picture = masks.picture(Some(event + 1)).unwrap();
            let found = picture.capsules(None, &Settings::default()).unwrap();
            for [x, y] in &found.capsules[0].points {
                assert!(((x - 60.0).hypot(y - 30.0) - radius(event)).abs() < 0.5);
            }
        }
        assert!(masks.picture(None).unwrap_err().to_string().contains("2 events"));
        assert!(masks.picture(Some(3)).unwrap_err().to_string().contains("--capsule 3"));
        let other = folder.path().join("other.h5");
        H5File::create(&other).unwrap().close().unwrap();
        let error = Masks::open(&other).err().map(|error| error.to_string());
        assert!(error.is_some_and(|error| error.contains("events/mask")));
    }
}
