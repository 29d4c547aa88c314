//! Looks of what lies below, and the light on it.

/// Look of a surface, each 0..1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Texture: gradient of its picture over that of one that the correlator follows well.
    pub contrast: f64,
    /// Diffuse reflectivity at the range's 940 nm.
    pub reflectivity: f64,
    /// Share of the light that it mirrors instead of scattering it.
    pub gloss: f64,
}

/// Looks of pipe and ground, and the light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Optics {
    /// The pipe.
    pub pipe: Look,
    /// The ground.
    pub ground: Look,
    /// Illumination, lux; `None`: the light has no effect.
    pub light: Option<f64>,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            contrast: 1.0,
            // Of the makers' tables of ranges.
            reflectivity: 0.9,
            gloss: 0.0,
        }
    }
}

impl Optics {
    /// Look of the pipe or the ground.
    #[must_use]
    pub const fn of(&self, pipe: bool) -> &Look {
        if pipe { &self.pipe } else { &self.ground }
    }
}
