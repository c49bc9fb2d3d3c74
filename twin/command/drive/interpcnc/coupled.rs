//! Parameter 86: an axis that goes along with X, whatever moves X.

use super::super::session::no_clock;
use super::HandBoard;
use crate::command::Failure;
use twin_interpcnc::BoardAxis;
use twin_interpcnc::protocol::parameters::COUPLING;

impl HandBoard {
    /// The axis that goes along where these are moved.
    ///
    /// # Errors
    /// If one of them is itself such an axis: alone it would be driven away from X, on whose carriage it is.
    pub(super) fn follower(
        &mut self,
        axes: &[BoardAxis],
        what: &str,
    ) -> Result<Option<BoardAxis>, Failure> {
        let concerned = [BoardAxis::X, BoardAxis::A, BoardAxis::B];
        if !axes.iter().any(|axis| concerned.contains(axis)) {
            return Ok(None);
        }
        let code = self.session.ask(self.board.parameter(COUPLING, &no_clock))?;
        of_code(code, axes, what).map_err(Failure::Usage)
    }
}

fn of_code(code: u32, axes: &[BoardAxis], what: &str) -> Result<Option<BoardAxis>, String> {
    let follower = match code {
        0 => return Ok(None),
        1 => BoardAxis::A,
        2 => BoardAxis::B,
        _ => {
            return Err(format!(
                "parameter {COUPLING} (coupling) is {code}, and takes 0 to 2: which axis goes along with X is not known (nothing was \
                 sent); `set coupling 0`, 1 or 2 says it"
            ));
        }
    };
    if axes.contains(&follower) {
        return Err(format!(
            "axis {follower} goes along with X (parameter {COUPLING}, coupling, is {code}), and would be driven away from it by itself \
             (nothing was sent): `{what} X` moves both, `set coupling 0` parts them"
        ));
    }
    Ok(axes.contains(&BoardAxis::X).then_some(follower))
}

/// Words of a question about the follower.
pub(super) fn with_follower(follower: Option<BoardAxis>) -> String {
    let words = |axis| format!("and axis {axis} with it (parameter {COUPLING}, coupling)");
    follower.map_or(String::new(), words)
}

#[cfg(test)]
mod tests {
    use super::of_code;
    use twin_interpcnc::BoardAxis::{A, B, X, Y};

    /// `EE_COUPLAGE_AXE`: 1 = A goes along with X, 2 = B does.
    #[test]
    fn a_coupled_axis_is_not_moved_alone() {
        assert_eq!(of_code(0, &[X, A, B], "home"), Ok(None));
        assert_eq!(of_code(1, &[X, B], "home"), Ok(Some(A)));
        assert_eq!(of_code(2, &[Y, X], "home"), Ok(Some(B)));
        assert_eq!(of_code(2, &[A, Y], "move"), Ok(None));
        let refused = of_code(1, &[A], "move").unwrap_err();
        assert!(refused.contains("axis A goes along with X") && refused.contains("`move X`"));
        assert!(of_code(2, &[X, B], "home").is_err());
        let unknown = of_code(5, &[X], "move").unwrap_err();
        assert!(unknown.contains("(coupling) is 5, and takes 0 to 2"), "{unknown}");
    }
}
