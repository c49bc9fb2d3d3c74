use super::machines::machine;
use crate::workspace::{View, Workspace, picture};

#[test]
fn draw() {
    for name in ["scara2", "gantry3"] {
        let machine = machine(&format!("{name}.toml"));
        let clock = std::time::SystemTime::now();
        let workspace = Workspace::survey(&machine, &View::default()).unwrap();
        let horizontal = workspace.horizontal();
        let example = workspace.example(&horizontal).unwrap().unwrap();
        println!("{name} {:?}", clock.elapsed());
        let text = picture(&workspace, &horizontal, Some(&example)).unwrap();
        println!("{name} {:?} {}", clock.elapsed(), text.len());
        std::fs::write(format!("/tmp/{name}-h.svg"), text).unwrap();
        let vertical = workspace.vertical().unwrap();
        let text = picture(&workspace, &vertical, Some(&example)).unwrap();
        println!("{name} {:?} {}", clock.elapsed(), text.len());
        std::fs::write(format!("/tmp/{name}-v.svg"), text).unwrap();
    }
}
