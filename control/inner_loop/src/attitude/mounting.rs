//! How the vehicle's inertial sensor sits in the vehicle, beyond what the board's file says of it.
//!
//! A board's driver hands over *board axes*: forward, right, down as the board's file has them. A mounting says where
//! these have the vehicle's nose, right side and belly, and turns a vector into the vehicle's body axes:
//! v·x = b·nose, v·y = b·right, v·z = b·belly.

use crate::maths::vector::Vec3;
use crate::params::ImuMounting;

/// A direction along an axis, forward, right and down being positive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Along x.
    Forward,
    /// Against x.
    Back,
    /// Along y.
    Right,
    /// Against y.
    Left,
    /// Along z.
    Down,
    /// Against z.
    Up,
}

impl Direction {
    /// All six.
    pub const ALL: [Self; 6] = [
        Self::Forward,
        Self::Back,
        Self::Right,
        Self::Left,
        Self::Down,
        Self::Up,
    ];

    /// For people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Forward => "forward",
            Self::Back => "back",
            Self::Right => "right",
            Self::Left => "left",
            Self::Down => "down",
            Self::Up => "up",
        }
    }

    /// Its unit vector.
    pub const fn unit(self) -> Vec3 {
        match self {
            Self::Forward => Vec3::new(1.0, 0.0, 0.0),
            Self::Back => Vec3::new(-1.0, 0.0, 0.0),
            Self::Right => Vec3::new(0.0, 1.0, 0.0),
            Self::Left => Vec3::new(0.0, -1.0, 0.0),
            Self::Down => Vec3::new(0.0, 0.0, 1.0),
            Self::Up => Vec3::new(0.0, 0.0, -1.0),
        }
    }

    /// Component of `v` along it.
    pub const fn of(self, v: Vec3) -> f32 {
        match self {
            Self::Forward => v.x,
            Self::Back => -v.x,
            Self::Right => v.y,
            Self::Left => -v.y,
            Self::Down => v.z,
            Self::Up => -v.z,
        }
    }

    /// The direction along `v`, a unit vector along an axis; `None` for any other.
    fn along(v: Vec3) -> Option<Self> {
        Self::ALL.into_iter().find(|direction| direction.unit() == v)
    }
}

/// Where the board's axes have three sides of the vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mounting {
    /// Its nose.
    pub nose: Direction,
    /// Its right side.
    pub right: Direction,
    /// Its belly.
    pub belly: Direction,
}

impl Mounting {
    /// As the board's file has it.
    pub const AS_BUILT: Self = Self {
        nose: Direction::Forward,
        right: Direction::Right,
        belly: Direction::Down,
    };

    /// The three are one of the 24 ways in which a sensor can sit; otherwise a side was mistaken.
    pub fn fits(&self) -> bool {
        self.nose.unit().cross(self.right.unit()) == self.belly.unit()
    }

    /// From board axes to the vehicle's.
    pub const fn to_vehicle(&self, v: Vec3) -> Vec3 {
        Vec3::new(self.nose.of(v), self.right.of(v), self.belly.of(v))
    }

    /// From the vehicle's axes to the board's.
    pub fn to_board(&self, v: Vec3) -> Vec3 {
        self.nose.unit() * v.x + self.right.unit() * v.y + self.belly.unit() * v.z
    }

    /// This mounting, found in axes that `before` has turned already: what both do together. `None` where the three
    /// sides are those of no mounting.
    pub fn after(&self, before: &Self) -> Option<Self> {
        let all = |direction: Direction| Direction::along(before.to_board(direction.unit()));
        let both = Self {
            nose: all(self.nose)?,
            right: all(self.right)?,
            belly: all(self.belly)?,
        };
        both.fits().then_some(both)
    }

    /// The parameter's value.
    pub fn parameter(&self) -> Option<ImuMounting> {
        let mut all = ImuMounting::ALL.iter().copied();
        all.find(|value| Self::from(*value) == *self)
    }
}

/// Directions of the belly, in the order of the parameter's numbers; each nose has the four that are across it.
const BELLIES: [Direction; 6] = [
    Direction::Down,
    Direction::Up,
    Direction::Right,
    Direction::Left,
    Direction::Forward,
    Direction::Back,
];

impl From<ImuMounting> for Mounting {
    fn from(value: ImuMounting) -> Self {
        let number = value.number() as usize;
        let nose = Direction::ALL.get(number / 4).copied();
        let nose = nose.unwrap_or(Direction::Forward);
        let across = |belly: &Direction| belly.unit().dot(nose.unit()).abs() < 0.5;
        let belly = BELLIES.into_iter().filter(across).nth(number % 4);
        let belly = belly.unwrap_or(Direction::Down);
        // Right-handed: y = z x x.
        let right = Direction::along(belly.unit().cross(nose.unit()));
        Self {
            nose,
            right: right.unwrap_or(Direction::Right),
            belly,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::collections::BTreeSet;
    use std::format;

    use super::*;

    #[test]
    fn the_parameter_has_each_of_the_24_by_the_names_of_nose_and_belly() {
        let mut seen = BTreeSet::new();
        for value in ImuMounting::ALL {
            let mounting = Mounting::from(*value);
            assert!(mounting.fits(), "{value:?}");
            assert_eq!(mounting.parameter(), Some(*value));
            let row = crate::params::Params::row("imu_mounting").unwrap();
            let name = row.choice(value.number()).unwrap().name;
            assert_eq!(
                name,
                format!("{}_{}", mounting.nose.name(), mounting.belly.name())
            );
            seen.insert(name);
        }
        assert_eq!(seen.len(), 24);
        assert_eq!(Mounting::from(ImuMounting::FORWARD_DOWN), Mounting::AS_BUILT);
    }

    /// The limit case of each rotation: a vehicle that rests on one side feels 1 g away from it, and one that turns
    /// about an axis turns about that axis, however the sensor sits.
    #[test]
    fn gravity_and_turns_end_where_the_vehicle_has_them() {
        for value in ImuMounting::ALL {
            let m = Mounting::from(*value);
            // What the board's axes read while each side is below, or while it turns about it.
            for (side, vehicle) in [
                (m.nose, Direction::Forward),
                (m.right, Direction::Right),
                (m.belly, Direction::Down),
            ] {
                let read = side.unit() * -9.81;
                assert!(m.to_vehicle(read) == vehicle.unit() * -9.81, "{value:?}");
                assert!(m.to_board(vehicle.unit()) == side.unit(), "{value:?}");
            }
            // A rotation: lengths, and no mirror.
            let (a, b) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(-2.0, 0.5, 4.0));
            assert!(m.to_board(m.to_vehicle(a)) == a);
            assert!(m.to_vehicle(a.cross(b)) == m.to_vehicle(a).cross(m.to_vehicle(b)));
        }
        // By hand: a board turned by 90 degrees to the left has the nose at its right.
        let left = Mounting {
            nose: Direction::Right,
            right: Direction::Back,
            belly: Direction::Down,
        };
        assert_eq!(left.parameter().map(ImuMounting::number), Some(8.0));
        assert!(left.to_vehicle(Vec3::new(0.0, 1.0, 0.0)) == Vec3::new(1.0, 0.0, 0.0));
        assert!(left.to_vehicle(Vec3::new(1.0, 0.0, 0.0)) == Vec3::new(0.0, -1.0, 0.0));
    }

    #[test]
    fn two_mountings_make_one() {
        let v = Vec3::new(1.0, 2.0, 3.0);
        for first in ImuMounting::ALL.iter().map(|m| Mounting::from(*m)) {
            for second in ImuMounting::ALL.iter().map(|m| Mounting::from(*m)) {
                let both = second.after(&first).unwrap();
                assert!(both.to_vehicle(v) == second.to_vehicle(first.to_vehicle(v)));
            }
        }
        let mistaken = Mounting {
            right: Direction::Left,
            ..Mounting::AS_BUILT
        };
        assert_eq!(mistaken.after(&Mounting::AS_BUILT), None);
    }
}
