//! Time stamps of an exchange between driver and device.

/// Time stamps of an exchange, on the caller's clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stamp {
    /// The first byte was handed to the port, ns.
    pub sent_ns: i64,
    /// The device executed the request, ns: the middle between the last byte of the request and the first byte of the
    /// answer.
    pub executed_ns: i64,
    /// Half the time between them: `executed_ns` is wrong by no more, ns.
    pub uncertainty_ns: i64,
    /// The answer was there, ns.
    pub answered_ns: i64,
}
