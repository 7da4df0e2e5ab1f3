//! `<transform>`: steps in file order, each applied after those before it.

use super::{
    document::Reader,
    plugin::elements,
    value::{self, abridged},
};
use crate::{
    error::LoadError,
    placement::{look_at, rotation},
};
use glam::{DAffine3, DMat3, DVec3};
use roxmltree::Node;

/// The transform that an element describes; it can be inverted.
pub(super) fn transform<'d>(reader: &Reader<'d>, node: Node<'d, 'd>) -> Result<DAffine3, LoadError> {
    reader.allow_attributes(node, &["name"])?;
    let mut whole = DAffine3::IDENTITY;
    for child in elements(reader, node)? {
        whole = step(reader, child)? * whole;
        if !whole.is_finite() {
            return Err(reader.error(child, "the transform is not finite from here on"));
        }
    }
    // Relative to the lengths of the columns, so that a small scale is not taken for a flat one.
    let m = whole.matrix3;
    let volume = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
    let flat = m.determinant().abs() <= 1e-12 * volume;
    if flat || !(volume.is_finite() && volume > 0.0) {
        return Err(reader.error(node, "the transform flattens space: it has no inverse"));
    }
    Ok(whole)
}

fn step<'d>(reader: &Reader<'d>, node: Node<'d, 'd>) -> Result<DAffine3, LoadError> {
    let tag = node.tag_name().name();
    match tag {
        "translate" => {
            reader.allow_attributes(node, &["value", "x", "y", "z"])?;
            Ok(DAffine3::from_translation(components(reader, node, 0.0)?))
        }
        "scale" => {
            reader.allow_attributes(node, &["value", "x", "y", "z"])?;
            Ok(DAffine3::from_scale(components(reader, node, 1.0)?))
        }
        "rotate" => {
            reader.allow_attributes(node, &["value", "x", "y", "z", "angle"])?;
            let axis = components(reader, node, 0.0)?;
            let axis = axis.try_normalize().ok_or_else(|| reader.error(node, "the axis has no direction"))?;
            Ok(DAffine3::from_mat3(rotation(axis, attribute(reader, node, "angle", value::number)?)))
        }
        "lookat" | "lookAt" => {
            reader.allow_attributes(node, &["origin", "target", "up"])?;
            let [origin, target, up] =
                ["origin", "target", "up"].map(|name| attribute(reader, node, name, value::vector));
            look_at(origin?, target?, up?)
                .ok_or_else(|| reader.error(node, "origin, target and up do not fix a direction of view"))
        }
        "matrix" => {
            reader.allow_attributes(node, &["value"])?;
            matrix(reader, node)
        }
        _ => {
            let known = "translate, rotate, scale, matrix, lookat";
            Err(reader.error(node, format!("<{}> is no step of a transform; steps: {known}", abridged(tag))))
        }
    }
}

/// Row by row, 4 x 4 or the linear 3 x 3 part alone.
fn matrix<'d>(reader: &Reader<'d>, node: Node<'d, 'd>) -> Result<DAffine3, LoadError> {
    let rows = attribute(reader, node, "value", |text| value::numbers(text, 16))?;
    match rows.as_slice() {
        &[a, b, c, d, e, f, g, h, i] => {
            Ok(DAffine3::from_mat3(DMat3::from_cols_array(&[a, b, c, d, e, f, g, h, i]).transpose()))
        }
        &[a, b, c, x, d, e, f, y, g, h, i, z, 0.0, 0.0, 0.0, 1.0] => {
            let linear = DMat3::from_cols_array(&[a, b, c, d, e, f, g, h, i]).transpose();
            Ok(DAffine3::from_mat3_translation(linear, DVec3::new(x, y, z)))
        }
        other if other.len() == 16 => Err(reader.error_in(node, "value", "the last row of the matrix is not 0 0 0 1")),
        other => Err(reader.error_in(node, "value", format!("a matrix has 16 or 9 numbers, not {}", other.len()))),
    }
}

/// Three numbers by `value` (one number counts for all three) or by `x`, `y` and `z`, each `default` if missing.
pub(super) fn components<'d>(reader: &Reader<'d>, node: Node<'d, 'd>, default: f64) -> Result<DVec3, LoadError> {
    if node.has_attribute("value") {
        if let Some(extra) = node.attributes().find(|a| ["x", "y", "z"].contains(&a.name())) {
            return Err(reader.error_at(extra.range().start, "is given by `value` already"));
        }
        return attribute(reader, node, "value", |text| match value::numbers(text, 3)?.as_slice() {
            &[v] if node.has_tag_name("scale") => Ok(DVec3::splat(v)),
            _ => value::vector(text),
        });
    }
    let mut out = DVec3::splat(default);
    for (i, name) in ["x", "y", "z"].into_iter().enumerate() {
        if node.has_attribute(name) {
            out[i] = attribute(reader, node, name, value::number)?;
        }
    }
    Ok(out)
}

fn attribute<'d, T>(
    reader: &Reader<'d>,
    node: Node<'d, 'd>,
    name: &str,
    parse: impl Fn(&str) -> Result<T, String>,
) -> Result<T, LoadError> {
    parse(&reader.substituted(node, name)?).map_err(|m| reader.error_in(node, name, m))
}
