//! Poses out of the three messages that carry one, in the axes of [`Pose`].

use sophie_control::maths::vector::{Quat, Vec3};
use sophie_ports::external_pose::Pose;

use super::{Refusal, bounded, rotation};
use sophie_dialect::{ATT_POS_MOCAP_DATA, ODOMETRY_DATA, VISION_POSITION_ESTIMATE_DATA};

/// Largest coordinate, m: beyond it a float has steps of a millimetre.
pub(super) const POSITION_MAX: f32 = 10_000.0;
/// Largest speed along an axis, m/s.
const SPEED_MAX: f32 = 100.0;
/// Largest angle, rad: a full turn.
const ANGLE_MAX: f32 = core::f32::consts::TAU;
/// Largest variance, in the square of its unit.
const VARIANCE_MAX: f32 = 1e6;
/// ODOMETRY's quality of a failed estimate.
const FAILED: i8 = -1;

/// MAV_FRAME, the frame of coordinates.
pub(super) const LOCAL_NED: u8 = 1;
const LOCAL_ENU: u8 = 4;
const BODY_NED: u8 = 8;
const BODY_FRD: u8 = 12;
const LOCAL_FRD: u8 = 20;
const LOCAL_FLU: u8 = 21;

/// World axes of a sender.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum World {
    /// North, east, down, or forward, right, down.
    Down,
    /// East, north, up.
    EastNorthUp,
    /// Forward, left, up.
    ForwardLeftUp,
}

impl World {
    fn of(frame: u8) -> Result<(Self, bool), Refusal> {
        match frame {
            LOCAL_NED => Ok((Self::Down, true)),
            LOCAL_ENU => Ok((Self::EastNorthUp, true)),
            LOCAL_FRD => Ok((Self::Down, false)),
            LOCAL_FLU => Ok((Self::ForwardLeftUp, false)),
            _ => Err(Refusal::Frame),
        }
    }

    fn vector(self, v: Vec3) -> Vec3 {
        match self {
            Self::Down => v,
            Self::EastNorthUp => Vec3::new(v.y, v.x, -v.z),
            Self::ForwardLeftUp => Vec3::new(v.x, -v.y, -v.z),
        }
    }

    fn attitude(self, q: Quat) -> Quat {
        let (x, y) = match self {
            Self::Down => return q,
            // Half a turn about the axis between north and east.
            Self::EastNorthUp => (core::f32::consts::FRAC_1_SQRT_2, core::f32::consts::FRAC_1_SQRT_2),
            // Half a turn about forward.
            Self::ForwardLeftUp => (1.0, 0.0),
        };
        Quat { w: 0.0, x, y, z: 0.0 } * q
    }

    /// Variances have no sign.
    fn variance(self, v: Vec3) -> Vec3 {
        self.vector(v).map(f32::abs)
    }
}

/// What ODOMETRY says. Its quaternion is from body FRD to the axes of the pose.
///
/// # Errors
/// Axes that are not known here, values that are no numbers or out of bounds, an estimate that has failed.
pub fn odometry(m: &ODOMETRY_DATA) -> Result<Pose, Refusal> {
    if m.quality == FAILED {
        return Err(Refusal::Value);
    }
    let (world, north) = World::of(m.frame_id)?;
    let attitude = rotation(m.q)?.map(|q| world.attitude(q));
    let (position_variance, attitude_variance) = variances(&m.pose_covariance)?;
    let mut pose = Pose {
        position: world.vector(bounded([m.x, m.y, m.z], POSITION_MAX)?),
        attitude,
        position_variance: position_variance.map(|v| world.variance(v)),
        // About axes that are turned they would be others.
        attitude_variance: attitude_variance.filter(|_| world == World::Down),
        north,
        resets: m.reset_counter,
        quality: u8::try_from(m.quality).ok().filter(|quality| *quality > 0),
        ..Pose::default()
    };
    if !m.vx.is_nan() {
        let velocity = bounded([m.vx, m.vy, m.vz], SPEED_MAX)?;
        let (variance, _) = variances(&m.velocity_covariance)?;
        set_velocity(&mut pose, m.child_frame_id, velocity, variance)?;
    }
    Ok(pose)
}

/// Sets a velocity in the axes of MAV_FRAME `frame`. One in the body's without an attitude is left out.
fn set_velocity(pose: &mut Pose, frame: u8, velocity: Vec3, variance: Option<Vec3>) -> Result<(), Refusal> {
    if let BODY_FRD | BODY_NED = frame {
        pose.velocity = pose.attitude.map(|q| q.rotate(velocity));
        pose.velocity_variance = pose.attitude.zip(variance).map(|(q, v)| turned(q, v));
        return Ok(());
    }
    let (world, north) = World::of(frame)?;
    if north != pose.north {
        return Err(Refusal::Frame);
    }
    pose.velocity = Some(world.vector(velocity));
    pose.velocity_variance = variance.map(|v| world.variance(v));
    Ok(())
}

/// What VISION_POSITION_ESTIMATE says, in NED.
///
/// # Errors
/// Values that are no numbers or out of bounds.
pub fn vision(m: &VISION_POSITION_ESTIMATE_DATA) -> Result<Pose, Refusal> {
    let attitude = if m.roll.is_nan() {
        None
    } else {
        let angles = bounded([m.roll, m.pitch, m.yaw], ANGLE_MAX)?;
        Some(Quat::from_euler(angles.x, angles.y, angles.z))
    };
    north_east_down([m.x, m.y, m.z], attitude, &m.covariance, m.reset_counter)
}

/// What ATT_POS_MOCAP says, in NED.
///
/// # Errors
/// As [`vision`].
pub fn mocap(m: &ATT_POS_MOCAP_DATA) -> Result<Pose, Refusal> {
    north_east_down([m.x, m.y, m.z], rotation(m.q)?, &m.covariance, 0)
}

fn north_east_down(
    position: [f32; 3],
    attitude: Option<Quat>,
    covariance: &[f32; 21],
    resets: u8,
) -> Result<Pose, Refusal> {
    let (position_variance, attitude_variance) = variances(covariance)?;
    Ok(Pose {
        position: bounded(position, POSITION_MAX)?,
        attitude,
        position_variance,
        attitude_variance,
        north: true,
        resets,
        ..Pose::default()
    })
}

/// Variances of the first and of the last three states in the upper triangle of a covariance, row by row. `None` if
/// they are not given: NaN in the first place, or the zeros of older senders.
fn variances(covariance: &[f32; 21]) -> Result<(Option<Vec3>, Option<Vec3>), Refusal> {
    let &[a, _, _, _, _, _, b, _, _, _, _, c, _, _, _, d, _, _, e, _, f] = covariance;
    if a.is_nan() {
        return Ok((None, None));
    }
    let sound = [a, b, c, d, e, f]
        .iter()
        .all(|value| (0.0..=VARIANCE_MAX).contains(value));
    let given = |v: Vec3| Some(v).filter(|v| v.norm_squared() > 0.0);
    let both = (given(Vec3::new(a, b, c)), given(Vec3::new(d, e, f)));
    sound.then_some(both).ok_or(Refusal::Value)
}

/// Variances along the world's axes, given independent variances along the body's axes.
fn turned(q: Quat, variance: Vec3) -> Vec3 {
    let along = |axis: Vec3, variance: f32| {
        let axis = q.rotate(axis);
        axis.scale_by(axis) * variance
    };
    along(Vec3::new(1.0, 0.0, 0.0), variance.x)
        + along(Vec3::new(0.0, 1.0, 0.0), variance.y)
        + along(Vec3::new(0.0, 0.0, 1.0), variance.z)
}
