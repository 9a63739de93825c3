#pragma once

#include <string>
#include <vector>

#include "pipeline/validation_case.hpp"

namespace deforma {

/// Whether every judged row keeps its limit.
bool all_limits_kept(const std::vector<ValidationRow>& rows);

/// Sorts rows as the table shows them: by quantity, setting, placement and particles across, whatever order they were
/// measured in.
void sort_rows(std::vector<ValidationRow>& rows);

/// The table with the sources of its references, what went wrong and how many kept what, in columns for a terminal.
std::string validation_text(const std::vector<ValidationRow>& rows);

/// The same as Markdown.
std::string validation_markdown(const std::vector<ValidationRow>& rows);

/// The rows as comma-separated values with a header line, numbers in full; errors, goals and limits are ratios.
std::string validation_csv(const std::vector<ValidationRow>& rows);

}  // namespace deforma
