//! Register lists there and back; their bytes are checked against vectors where they are sent and received.
