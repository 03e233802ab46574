//! The surface for `predict`: positions, velocities and the mechanics of the membrane.

use crate::fields::{self, Column, Field, Strained, Surface, Totals};
use anyhow::Result;
use capsule_core::mechanics::{self, Deformation, Stencil};
use capsule_core::{EvaluateError, Evaluator, Frame, Model, Nodes, Real, Scene};

/// The requested fields, and the operators that they need.
pub struct Mechanics<'o, T> {
    fields: &'o [Field],
    capillary_number: T,
    /// Indices of the sector's nodes.
    stencils: Vec<Stencil<T>>,
    sector: Vec<[T; 3]>,
}

impl<'o, T: Real> Mechanics<'o, T> {
    /// `None` if no field is requested.
    pub fn new(model: &Model<'_>, fields: &'o [Field], capillary_number: T) -> Result<Option<Self>> {
        if fields.is_empty() {
            return Ok(None);
        }
        if !model.has_mechanics() {
            return Err(EvaluateError::UnsupportedReference.into());
        }
        let mesh = model.mesh();
        let nodes = mesh.sector_nodes();
        let stencils = nodes.iter().map(|node| Stencil::at(&mesh, node));
        Ok(Some(Self {
            fields,
            capillary_number,
            stencils: stencils.collect::<Result<_, _>>()?,
            sector: vec![[T::ZERO; 3]; nodes.len()],
        }))
    }

    /// The deformations at the sector's nodes.
    fn deformations(&mut self, evaluator: &mut Evaluator<'_, T>, t: T) -> Result<Vec<Deformation<T>>> {
        let membrane = evaluator.at(t)?.membrane(&mut self.sector)?;
        let deformations = self.stencils.iter().map(|stencil| membrane.deformation(stencil));
        Ok(deformations.collect::<Result<_, _>>()?)
    }

    /// Totals and extremes at an instant.
    pub fn totals(&mut self, evaluator: &mut Evaluator<'_, T>, t: T) -> Result<Totals<T>> {
        let nodes: Vec<Strained<T>> = self.deformations(evaluator, t)?.into_iter().map(Into::into).collect();
        let [max_stretch, max_tension, min_tension] = fields::extremes(&nodes);
        let mechanics::Totals {
            area,
            energy,
            pressure_drop,
        } = evaluator.at(t)?.membrane(&mut self.sector)?.totals()?;
        Ok(Totals {
            area,
            energy,
            pressure_drop,
            max_stretch,
            max_tension,
            min_tension,
        })
    }
}

/// All nodes at an instant, with velocities and the requested fields.
pub fn surface<T: Real>(
    model: &Model<'_>,
    evaluator: &mut Evaluator<'_, T>,
    mechanics: Option<&mut Mechanics<T>>,
    t: T,
) -> Result<Surface> {
    let scene = Scene {
        nodes: Nodes::All,
        frame: Frame::Laboratory,
    };
    let mesh = model.mesh();
    let mut nodes = vec![[T::ZERO; 3]; mesh.nodes()];
    let mut instant = evaluator.at(t)?;
    instant.positions(&scene, &mut nodes)?;
    let positions = nodes.iter().map(|point| point.map(T::to_f64)).collect();
    instant.velocities(&scene, &mut nodes)?;
    let mut columns = vec![Column::vectors("velocity", nodes)];
    if let Some(mechanics) = mechanics {
        let sector = mechanics.deformations(evaluator, t)?;
        let carried = |(index, operation): (usize, u8)| sector[index].transformed(operation);
        let full: Vec<_> = (0..mesh.nodes())
            .filter_map(|node| mesh.origin(node))
            .map(carried)
            .collect();
        let load = || {
            Ok(full
                .iter()
                .map(|at| at.load(mechanics.capillary_number))
                .collect::<Result<_, _>>()?)
        };
        let strained: Vec<_> = full.iter().copied().map(Strained::from).collect();
        columns.extend(fields::columns(mechanics.fields, &strained, load)?);
    }
    Ok(Surface {
        time: t.to_f64(),
        positions,
        columns,
    })
}
