mod frame;
mod machine_axes;
