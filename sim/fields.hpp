#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "sim/effect.hpp"
#include "sim/state.hpp"

namespace deforma {

/// What can be told of every point of a deformed body by one number.
enum class FieldKind { displacement, speed, von_mises, principal_stretch, det_f, energy_density };

/// One row of the table of fields.
struct FieldInfo {
  FieldKind kind;
  std::string_view name;   ///< as scenes write it
  std::string_view title;  ///< for people
  std::string_view unit;   ///< SI; "1" for a ratio
  double at_rest;          ///< its value where nothing has happened yet
  double least;            ///< it is never below
};

std::span<const FieldInfo> field_registry();
std::span<const std::string_view> field_names();

/// @throws std::invalid_argument for a name that is no field; the message lists the names.
const FieldInfo& find_field(std::string_view name);

/// The values of a field now, at particles and at the vertices of the surface.
///
/// Displacement and speed of a vertex are those of the drawn surface (eq 25 and its rate). All else is found at the
/// particles, from F and from the first Piola-Kirchhoff stress P that the effects answer to it, viscous stress
/// included, and is taken to the vertices by the weights of the skin. The Cauchy stress is P F^T / det F; von Mises:
/// sqrt(3/2) times the norm of its deviator. Directions that a particle's neighbours do not span (a sheet, a rope)
/// count as not stretched. The energy density, per volume at rest, is that of all effects whose stress derives from
/// one; energy between pairs (hourglass control, Lennard-Jones) is left out.
///
/// @param state        with F_rate up to date where some effect needs it
/// @param effects      those that the state is simulated with
/// @param at_particles written, n; or empty where it is not wanted
/// @param at_vertices  written, m; or empty
/// @throws std::invalid_argument when the lengths differ.
void evaluate_field(const FieldInfo& field, const State& state,
                    std::span<const std::unique_ptr<Effect>> effects, std::span<float> at_particles,
                    std::span<float> at_vertices);

}  // namespace deforma
