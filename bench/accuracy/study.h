#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace fettle::bench {

/// One method, measured: its error and its time.
struct AccuracyRow {
  std::string subject;  ///< input: "noise", "step", a file's name
  std::string method;
  double cost = 0.0;           ///< median [Study::cost]
  double cost_worst = 0.0;     ///< of the repeats
  double error = 0.0;          ///< mean or root mean square, according to Study::error [its unit]
  double error_p99 = 0.0;      ///< NaN: not computed
  double error_worst = 0.0;    ///< likewise
  double wrong = 0.0;          ///< share of cases that Study::wrong_name names, 0 .. 1; NaN: none
  std::uint64_t hash = 0;      ///< of the result: the same on every run of the same build
  std::string note{};          ///< a short remark
  std::vector<double> more{};  ///< of Study::columns, as many; NaN: does not apply
};

/// What an axis shows.
struct Quantity {
  std::string name;       ///< without unit
  const char* unit = "";  ///< a literal
};

/// A trade of accuracy against time: several methods on several subjects, against one reference.
struct Study {
  std::string id;                      ///< "contact"
  std::string title;                   ///< of its section
  std::string question;                ///< that its figures answer
  Quantity cost;                       ///< of the plot's horizontal axis
  Quantity error;                      ///< of the vertical axis
  std::string wrong_name{};            ///< empty: rows have no share of wrong ones
  std::string reference{};             ///< reference of the errors, and how it was checked
  std::string answer{};                ///< one or two sentences with the rows' figures
  bool cost_from_zero = false;         ///< the horizontal axis is even, from 0; else by factors
  std::vector<std::string> columns{};  ///< further figures of each row, with unit: "flats [um]"
  std::vector<AccuracyRow> rows{};
  /// The same rows over other axes, or the best of them: additional plots in the same section. Only id,
  /// title, names and units of the axes, and rows count.
  std::vector<Study> views{};
};

}  // namespace fettle::bench
