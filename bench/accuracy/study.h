#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace fettle::bench {

/// One way of doing something, measured: what it gives away in accuracy and what it takes in time.
struct AccuracyRow {
  std::string subject;  ///< what it was tried on: "noise", "step", a file's name
  std::string method;
  double cost = 0.0;         ///< median [Study::cost_unit]
  double cost_worst = 0.0;   ///< of the repeats
  double error = 0.0;        ///< mean or root mean square, as Study::error_name says [Study::error_unit]
  double error_p99 = 0.0;    ///< NaN: not worked out
  double error_worst = 0.0;  ///< likewise
  double wrong = 0.0;        ///< share of cases that Study::wrong_name names, 0 .. 1; NaN: none
  std::uint64_t hash = 0;    ///< of the result: the same on every run of the same build
  std::string note;          ///< what else there is to say, in a few words
  std::vector<double> more;  ///< of Study::columns, as many; NaN: does not apply
};

/// A trade of accuracy against time: ways of doing the same, on several subjects, against one reference.
struct Study {
  std::string id;              ///< "contact"
  std::string title;           ///< of its section
  std::string question;        ///< that its figures answer
  std::string cost_name;       ///< of the plot's horizontal axis, without unit
  const char* cost_unit = "";  ///< a literal, like error_unit
  std::string error_name;      ///< of the vertical axis
  const char* error_unit = "";
  std::string wrong_name;            ///< empty: rows have no share of wrong ones
  std::string reference;             ///< what errors are measured against, and how that is checked itself
  std::string answer;                ///< in a sentence or two, made of the rows' figures
  bool cost_from_zero = false;       ///< the horizontal axis is even, from 0; else by factors
  std::vector<std::string> columns;  ///< further figures of each row, with unit: "flats [um]"
  std::vector<AccuracyRow> rows;
  /// The same rows seen another way, or the best of them: plots of their own in the same section. Only id,
  /// title, names and units of the axes, and rows count.
  std::vector<Study> views;
};

}  // namespace fettle::bench
