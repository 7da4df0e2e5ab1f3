//! `<transform>`: steps in file order, each applied after those before it.

use super::{tree::Node, value};
use crate::{
    error::{LoadError, abridged},
    placement::{look_at, rotation},
};
use glam::{DAffine3, DMat3, DVec3};

/// The transform that an element describes; it can be inverted.
pub(super) fn transform(node: Node) -> Result<DAffine3, LoadError> {
    node.allow_attributes(&["name", "id"])?;
    let mut whole = DAffine3::IDENTITY;
    for child in node.children() {
        whole = step(child)? * whole;
        if !whole.is_finite() {
            return Err(child.error("the transform is not finite from here on"));
        }
    }
    // Relative to the lengths of the columns, so that a small scale is not taken for a flat one.
    let m = whole.matrix3;
    let volume = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
    let flat = m.determinant().abs() <= 1e-12 * volume;
    if flat || !(volume.is_finite() && volume > 0.0) {
        return Err(node.error("the transform flattens space: it has no inverse"));
    }
    Ok(whole)
}

fn step(node: Node) -> Result<DAffine3, LoadError> {
    match node.tag() {
        "translate" => {
            node.allow_attributes(&["value", "x", "y", "z"])?;
            Ok(DAffine3::from_translation(components(node, 0.0)?))
        }
        "scale" => {
            node.allow_attributes(&["value", "x", "y", "z"])?;
            Ok(DAffine3::from_scale(components(node, 1.0)?))
        }
        "rotate" => {
            node.allow_attributes(&["value", "x", "y", "z", "angle"])?;
            let axis = components(node, 0.0)?;
            let axis = axis.try_normalize().ok_or_else(|| node.error("the axis has no direction"))?;
            Ok(DAffine3::from_mat3(rotation(axis, attribute(node, "angle", value::number)?)))
        }
        "lookat" | "lookAt" => {
            node.allow_attributes(&["origin", "target", "up"])?;
            let origin = attribute(node, "origin", value::vector)?;
            let target = attribute(node, "target", value::vector)?;
            let up = match node.attribute("up") {
                Some(text) if !text.trim().is_empty() => attribute(node, "up", value::vector)?,
                _ => DVec3::ZERO,
            };
            // Without a way up Mitsuba takes the first vector of the basis of [Duff et al. 2017] around the view.
            let any = |forward: DVec3| forward.any_orthonormal_pair().0;
            let up = if up == DVec3::ZERO { (target - origin).try_normalize().map(any) } else { Some(up) };
            let placed = up.and_then(|up| look_at(origin, target, up));
            placed.ok_or_else(|| node.error("origin, target and up do not fix a direction of view"))
        }
        "matrix" => {
            node.allow_attributes(&["value"])?;
            matrix(node)
        }
        tag => {
            let known = "translate, rotate, scale, matrix, lookat";
            Err(node.error(format!("<{}> is no step of a transform; steps: {known}", abridged(tag))))
        }
    }
}

/// Row by row, 4 x 4 or the linear 3 x 3 part alone.
fn matrix(node: Node) -> Result<DAffine3, LoadError> {
    let rows = attribute(node, "value", |text| value::numbers(text, 16))?;
    match rows.as_slice() {
        &[a, b, c, d, e, f, g, h, i] => {
            Ok(DAffine3::from_mat3(DMat3::from_cols_array(&[a, b, c, d, e, f, g, h, i]).transpose()))
        }
        &[a, b, c, x, d, e, f, y, g, h, i, z, 0.0, 0.0, 0.0, 1.0] => {
            let linear = DMat3::from_cols_array(&[a, b, c, d, e, f, g, h, i]).transpose();
            Ok(DAffine3::from_mat3_translation(linear, DVec3::new(x, y, z)))
        }
        other if other.len() == 16 => Err(node.error_in("value", "the last row of the matrix is not 0 0 0 1")),
        other => Err(node.error_in("value", format!("a matrix has 16 or 9 numbers, not {}", other.len()))),
    }
}

/// Three numbers by `value` (one counts for all three) or by `x`, `y` and `z`, each `default` if missing.
pub(super) fn components(node: Node, default: f64) -> Result<DVec3, LoadError> {
    if node.attribute("value").is_some() {
        if let Some(extra) = ["x", "y", "z"].into_iter().find(|name| node.attribute(name).is_some()) {
            return Err(node.error_on(extra, "is given by `value` already"));
        }
        return attribute(node, "value", |text| match value::numbers(text, 3)?.as_slice() {
            &[v] => Ok(DVec3::splat(v)),
            _ => value::vector(text),
        });
    }
    let mut out = DVec3::splat(default);
    for (i, name) in ["x", "y", "z"].into_iter().enumerate() {
        if node.attribute(name).is_some() {
            out[i] = attribute(node, name, value::number)?;
        }
    }
    Ok(out)
}

fn attribute<T>(node: Node, name: &str, parse: impl Fn(&str) -> Result<T, String>) -> Result<T, LoadError> {
    parse(node.required(name)?).map_err(|m| node.error_in(name, m))
}
