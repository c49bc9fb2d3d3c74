//! Additional axes P Q U V W and their numbers, from 0.

use twin_path::EXTRA_AXES;

/// Number of the additional axis `role`; `None` for other roles.
pub(super) fn number(role: &str) -> Option<u8> {
    (0..).zip(EXTRA_AXES).find(|(_, letter)| letter.to_string() == role).map(|(number, _)| number)
}
