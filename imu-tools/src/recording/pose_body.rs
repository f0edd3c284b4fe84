//! Messages that tell a pose, and what they are behind their header, in ROS 1 and in ROS 2.
//!
//! Three of position, then four of the rotation as a quaternion x y z w; some have a text in front (the name
//! of the frame that is moved), some more doubles behind (covariances; the twist of an odometry). The
//! definitions are those of geometry_msgs and nav_msgs, the same in all distributions of ROS.

use super::poses::Pose;

/// Bytes of position and rotation.
pub const LEN: usize = 7 * 8;

/// A type of message that tells a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PoseMessage {
    /// `geometry_msgs/PoseStamped`.
    Pose,
    /// `geometry_msgs/PoseWithCovarianceStamped`.
    WithCovariance,
    /// `geometry_msgs/TransformStamped`, the pose of the child's frame.
    Transform,
    /// `nav_msgs/Odometry`.
    Odometry,
}

impl PoseMessage {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Pose, Self::WithCovariance, Self::Transform, Self::Odometry];

    /// Name of the type in ROS 1.
    pub const fn type_name(self) -> &'static str {
        match self {
            Self::Pose => "geometry_msgs/PoseStamped",
            Self::WithCovariance => "geometry_msgs/PoseWithCovarianceStamped",
            Self::Transform => "geometry_msgs/TransformStamped",
            Self::Odometry => "nav_msgs/Odometry",
        }
    }

    /// Fingerprint of its definition in ROS 1.
    pub const fn md5sum(self) -> &'static str {
        match self {
            Self::Pose => "d3812c3cbc69362b77dc0b19b345f8f5",
            Self::WithCovariance => "953b798c0f514ff060a53a3498ce6246",
            Self::Transform => "b5764a33bfeb3588febc2682852579b0",
            Self::Odometry => "cd5e73d190d741a2f92e81eda573aca7",
        }
    }

    /// The one of this name, in ROS 1 or in ROS 2, whose names have `msg` in the middle.
    pub fn named(type_name: &str) -> Option<Self> {
        let is = |name: &str| match type_name.split_once("/msg/") {
            Some((package, rest)) => name.split_once('/') == Some((package, rest)),
            None => name == type_name,
        };
        Self::ALL.into_iter().find(|message| is(message.type_name()))
    }

    /// Texts between its header and its doubles.
    pub const fn texts(self) -> usize {
        match self {
            Self::Pose | Self::WithCovariance => 0,
            Self::Transform | Self::Odometry => 1,
        }
    }

    /// Bytes of its doubles.
    pub const fn len(self) -> usize {
        const COVARIANCE: usize = 36 * 8;
        match self {
            Self::Pose | Self::Transform => LEN,
            Self::WithCovariance => LEN + COVARIANCE,
            Self::Odometry => LEN + COVARIANCE + 6 * 8 + COVARIANCE,
        }
    }
}

/// The pose at `stamp_ns`; `double` reads the one at an offset.
pub fn read(stamp_ns: i64, double: impl Fn(usize) -> f64) -> Pose {
    Pose {
        stamp_ns,
        position: [0, 8, 16].map(&double),
        orientation: [24, 32, 40, 48].map(&double),
        velocity: None,
        bias: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_both_kinds_of_ros() {
        for message in PoseMessage::ALL {
            let name = message.type_name();
            assert_eq!(PoseMessage::named(name), Some(message));
            let second = name.replace('/', "/msg/");
            assert_eq!(PoseMessage::named(&second), Some(message));
        }
        for other in ["geometry_msgs/Pose", "nav_msgs/msg/msg/Odometry", "Odometry", "", "/msg/"] {
            assert_eq!(PoseMessage::named(other), None, "{other}");
        }
    }
}
