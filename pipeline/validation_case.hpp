#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pipeline/validation_criterion.hpp"
#include "pipeline/validation_scene.hpp"

namespace deforma {

/// What a case has measured: a value for every quantity that `validation_criteria` lists for it, or fewer.
struct Measured {
  std::vector<std::pair<std::string_view, double>> values;  ///< quantity, value
  double largest_strain = 0.0;                              ///< over all particles
};

/// One experiment whose outcome is known.
struct ValidationCase {
  std::string_view name;
  std::string_view summary;
  std::vector<int> sizes;  ///< particles across
  bool small;              ///< its reference holds for small strain
  double weight;           ///< of its work, beside that of other cases of as many particles across

  std::function<std::string(const ValidationVariant&)> scene;  ///< TOML
  std::function<std::string(const ValidationVariant&)>
      mesh;  ///< OBJ that the scene names; empty when there is none

  /// Simulates the world built from that scene and measures.
  /// @throws std::runtime_error when no value could be had; the message says why.
  std::function<Measured(const Scene&, World&, const ValidationVariant&)> measure;
};

/// Every case, in the table's order.
const std::vector<ValidationCase>& validation_cases();

// The cases by kind, each in a file of its own.
std::vector<ValidationCase> static_validation_cases();
std::vector<ValidationCase> field_validation_cases();
std::vector<ValidationCase> mode_validation_cases();
std::vector<ValidationCase> motion_validation_cases();
std::vector<ValidationCase> conservation_validation_cases();

/// Static equilibrium to 1e-6 of the load.
/// @throws std::runtime_error when it is not reached.
void settle(Solver& solver, double tolerance = 1e-6);

/// One line of the table.
struct ValidationRow {
  const Criterion* criterion;
  ValidationVariant variant;
  std::size_t particles = 0;  ///< solved for
  double value;               ///< not a number when there is none
  double strain = 0.0;        ///< the largest
  bool small = false;         ///< whether it has to stay small
  double cpu = 0.0;           ///< of the whole case, reading its scene included [s]
  std::string trouble;        ///< why there is no value
  bool judged() const { return variant.setting->judged; }
  Verdict verdict() const;
};

/// Runs one case on the calling thread alone: a row for each of its quantities, with what went wrong instead of a value
/// where something did.
/// @param overrides keys of its scene given other values
/// @throws UserError when the scene does not take them.
std::vector<ValidationRow> run_case(const ValidationCase& validated, const ValidationVariant& variant,
                                    const std::vector<Override>& overrides = {});

/// Writes the scene of a case, and the mesh that it names, to a folder.
/// @return the scene's file
std::filesystem::path write_case(const ValidationCase& validated, const ValidationVariant& variant,
                                 const std::filesystem::path& folder);

}  // namespace deforma
