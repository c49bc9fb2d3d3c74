//! Other Modbus software at the other end of the wire: mbpoll (libmodbus) and pymodbus as masters of the emulated board,
//! pymodbus as a board for the driver.
//!
//! `TWIN_PYMODBUS_PYTHON` names a Python that has pymodbus 3.16.1, if the usual one has it not; mbpoll is taken from
//! the path. What is not there is said and not tested; `.ci/run` installs both where it can.

mod mbpoll;
mod pymodbus;
