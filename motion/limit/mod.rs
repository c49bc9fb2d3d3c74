//! Feed limiting: the fastest motion along a path under the limits of every axis.

mod course;

pub use course::{Blend, Course, CourseElement, CourseOptions, CoursePoint, Joint, Order};
