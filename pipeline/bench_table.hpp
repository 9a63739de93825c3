#pragma once

#include <string>
#include <variant>
#include <vector>

namespace deforma {

/// One column of a table of measurements.
struct BenchColumn {
  std::string key;      ///< in JSON; it ends with the unit
  std::string heading;  ///< in text, of two lines
  int decimals = 0;     ///< of its numbers
};

/// Measurements of one kind. A number that is not finite is one that there is not.
struct BenchTable {
  using Cell = std::variant<std::string, double>;

  std::string name;  ///< in JSON
  std::string title;
  std::vector<BenchColumn> columns;
  std::vector<std::vector<Cell>> rows;  ///< as many cells as columns
  std::vector<std::string> notes;       ///< below it
};

/// The table in columns for a terminal.
std::string bench_text(const BenchTable& table);

/// What the measurements were made on.
struct BenchMachine {
  std::string processor;
  int processors = 0;
  int threads = 0;             ///< that were allowed
  double bandwidth = 0.0;      ///< of one thread [bytes/s]
  double bandwidth_all = 0.0;  ///< of all that were allowed [bytes/s]
};

std::string bench_text(const BenchMachine& machine);

/// All of it: an object with the version, the machine, and for each table an array of objects.
std::string bench_json(const BenchMachine& machine, const std::vector<BenchTable>& tables);

}  // namespace deforma
