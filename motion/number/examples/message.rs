//! Numbers of a message: a value and its limit with as many digits as tell them apart.
//!
//! ```text
//! cargo run -p twin-number --example message
//! ```

use twin_number::{Short, apart, at_most, counted, exact_seconds};

fn main() {
    // A velocity of 205.000 000 4 mm/s against a limit of 205 mm/s.
    let [value, limit] = apart(205.000_000_4, 205.0);
    println!("axis A1: {value} mm/s is above {limit} mm/s");
    assert_eq!([value.as_str(), limit.as_str()], ["205.0000004", "205"]);

    // A feed that must not be exceeded is rounded down.
    let feed = at_most(361.127_73, 6);
    println!("largest feed: {feed} mm/s");
    assert_eq!(feed, "361.127");

    let [length, time] = [Short(0.3 * 1e3).to_string(), exact_seconds(12_000_000)];
    println!("{}, {length} mm, {time} s", counted(3, "element"));
    assert_eq!([length.as_str(), time.as_str()], ["300", "0.012"]);
}
