//! Pictures below each other in one.

/// Width and height of a picture, as its first line has them.
fn size(page: &str) -> Option<[f64; 2]> {
    let value = |key: &str| {
        let text = page.split_once(&format!("{key}=\""))?.1.split('"').next()?;
        text.parse::<f64>().ok()
    };
    Some([value("<svg width")?, value(" height")?])
}

/// One picture of several, the first one on top. One alone stays as it is.
pub fn stacked(pages: &[String]) -> String {
    if let [page] = pages {
        return page.clone();
    }
    let (mut width, mut height) = (0.0_f64, 0.0);
    let mut inside = String::new();
    for page in pages {
        let Some([wide, high]) = size(page) else { continue };
        inside.push_str(&page.replacen("<svg ", &format!("<svg y=\"{height}\" "), 1));
        width = width.max(wide);
        height += high;
    }
    let begin = r#"<svg xmlns="http://www.w3.org/2000/svg""#;
    format!(
        "{begin} width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n{inside}</svg>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::stacked;

    #[test]
    fn the_second_begins_where_the_first_ends() {
        let page = |height| format!("<svg width=\"100\" height=\"{height}\" x>\n</svg>\n");
        let both = stacked(&[page(30), page(50)]);
        assert!(both.contains(r#"width="100" height="80" viewBox="0 0 100 80""#), "{both}");
        assert!(both.contains(r#"<svg y="0" width="100" height="30""#), "{both}");
        assert!(both.contains(r#"<svg y="30" width="100" height="50""#), "{both}");
        assert_eq!(stacked(&[page(30)]), page(30));
    }
}
