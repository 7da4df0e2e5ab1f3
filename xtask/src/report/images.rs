//! An image beside its reference, with a slider, and its error map.

use crate::{
    error_map::{RANGE, colour, error_map_png},
    report::{
        Section, Series,
        text::{escape, png_url, superscript},
    },
};

/// The figure of a series.
pub fn figure(section: &Section, series: &Series) -> String {
    let Some(image) = series.image.as_ref().filter(|i| i.size == section.reference.picture.size) else {
        return String::new();
    };
    let reference = &section.reference.picture;
    let exposure = reference.exposure();
    let (ours, truth) = (png_url(&image.png(exposure)), png_url(&reference.png(exposure)));
    let map = png_url(&error_map_png(image, reference));
    let (w, h) = (image.size.x, image.size.y);
    let label = escape(&series.label);
    let end = series.end();
    format!(
        "<div class=\"images\">\
         <figure><div class=\"slider\" style=\"aspect-ratio:{w}/{h}\">\
         <img src=\"{truth}\" alt=\"reference\"><img class=\"over\" src=\"{ours}\" alt=\"{label}\">\
         <span class=\"tag left\">{label}, {} passes</span><span class=\"tag right\">reference</span><i></i>\
         <input type=\"range\" min=\"0\" max=\"100\" step=\"0.1\" value=\"50\" aria-label=\"{label} or reference\"></div>\
         <figcaption>Drag to compare: {label} on the left, the reference on the right.</figcaption></figure>\
         <figure><div class=\"map\" style=\"aspect-ratio:{w}/{h}\"><img src=\"{map}\" alt=\"error map\"></div>\
         <figcaption>Squared relative error of each pixel. {}</figcaption></figure></div>",
        end.passes,
        colour_bar()
    )
}

/// The colours of the map with their errors.
fn colour_bar() -> String {
    let stops = (0..=10).map(|i| {
        let [r, g, b] = colour(f64::from(i) / 10.0);
        format!("rgb({r},{g},{b}) {}%", 10 * i)
    });
    let stops = stops.collect::<Vec<_>>().join(",");
    let decade = |v: f64| format!("10{}", superscript(v.log10().round() as i32));
    format!(
        "<span class=\"bar\"><b>{}</b><span style=\"background:linear-gradient(90deg,{stops})\"></span><b>{}</b></span>",
        decade(RANGE.0),
        decade(RANGE.1)
    )
}
