#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace fettle::app {

/// What the value of a parameter is. The order is that of valueKinds().
enum class ValueKind : std::uint8_t {
  kByTarget,  ///< a flag, text, whole number or number, as the variable is
  kFlag,
  kText,
  kWord,
  kWhole,
  kNumber,
  kLength,
  kSize,
  kFormat,
  kInput,
  kOutput,
  kFile,
  kMarks,  ///< a file to read: a picture of marks
  kLines,  ///< a file to read: edge lines
  kNewFile,
  kNewScan,
  kNewMarks,
  kNewLines,
  kFolder,
};

/// How a kind is called.
struct ValueKindInfo {
  ValueKind kind;
  std::string_view word;   ///< in `fettle reference`'s parameters.json
  std::string_view shown;  ///< in the help; empty for a flag
  std::string_view text;   ///< what may be typed
};

[[nodiscard]] std::span<const ValueKindInfo> valueKinds();
[[nodiscard]] const ValueKindInfo& infoOf(ValueKind kind);

/// Allowed values, both ends included; infinite where there is no bound.
struct Range {
  double lowest;
  double highest;
};

/// One of the words that a parameter takes.
struct Word {
  // NOLINTNEXTLINE(google-explicit-constructor): rows name words as they are typed
  Word(const char* typed) : word(typed) {}
  // NOLINTNEXTLINE(google-explicit-constructor)
  Word(std::string_view typed) : word(typed) {}
  // NOLINTNEXTLINE(google-explicit-constructor)
  Word(std::string typed, std::string meaning = {}) : word(std::move(typed)), text(std::move(meaning)) {}

  std::string word;
  std::string text;  ///< what it means; may be empty
};

/// Where a value goes when the command line was read: a variable, which must exist until then, or a function.
/// Nothing for what the parser answers itself.
using Target =
    std::variant<std::monostate, bool*, std::string*, std::vector<std::string>*, int*, std::vector<int>*,
                 std::int64_t*, std::uint64_t*, double*, std::optional<double>*, std::vector<double>*,
                 std::function<void()>, std::function<void(const std::string&)>,
                 std::function<void(const std::vector<std::string>&)>>;

/// One row of the table of a command's parameters. Help, man pages, completion and the reference are made of
/// these rows, and the parser takes its checks from them.
struct Parameter {
  std::string name;  ///< "--window", "-q,--quiet", or a positional argument: "SCAN"
  Target to = {};
  std::string text = {};  ///< what it does; no period at the end
  ValueKind kind = ValueKind::kByTarget;
  std::optional<Range> range = {};
  /// Of a number, in the plural: "samples"; of a length not the scan's. A number of kMillimetres may be typed with another unit behind it.
  std::string unit = {};
  std::vector<Word> words =
      {};  ///< the only ones that are taken; of a text those that it begins with, and `problem` checks it
  /// Words that completion offers among others that are taken; `problem` or the command refuses a wrong one.
  std::vector<std::string> proposed = {};
  std::string shown = {};  ///< its value in the help instead of that of the kind: "X[,Y]"
  /// What counts where it is not given, in words. Where this is empty, the variable's value at the time at
  /// which the row is added; nothing of an empty text or list.
  std::string otherwise = {};
  std::string group = {};  ///< heading; empty: "Options"
  int values = 1;          ///< exactly so many, of a target with several
  char between = '\0';     ///< between values that are typed as one word
  bool one_word = false;   ///< the word after the value is not another value
  bool required = false;
  std::vector<std::string> excludes = {};  ///< only one of these and of this may be given
  /// The problem of a value as typed, or an empty text; in addition to range, words and kind.
  std::function<std::string(const std::string&)> problem = {};

  [[nodiscard]] bool positional() const { return !name.starts_with('-'); }
  [[nodiscard]] bool several() const;           ///< takes more than one value
  [[nodiscard]] std::string longName() const;   ///< "--quiet" of "-q,--quiet"; "SCAN"
  [[nodiscard]] std::string shortName() const;  ///< "-q" of "-q,--quiet"; empty: none
  [[nodiscard]] std::string standard() const;   ///< value of the variable, as text; of a required one none
};

/// A command line to try, and what it does.
struct Example {
  std::string line;
  std::string text;
};

/// A command with its parameters, or a group of commands.
struct CommandTable {
  std::string path;  ///< "fettle bench haptic"
  std::string name;  ///< "haptic"
  std::string summary;
  std::string notes = {};  ///< paragraphs, after the parameters; each is one line of this text
  std::vector<Parameter> parameters = {};
  std::vector<Example> examples = {};
  std::deque<CommandTable> commands = {};
};

/// The unit of rows whose lengths and places are millimetres, or in another unit that is typed behind them.
inline constexpr const char* kMillimetres = "mm";

/// The heading of the rows that every command has.
inline constexpr const char* kReportGroup = "Report and help";

/// The headings of a command's options in the order of their first row, "Options" first and kReportGroup last.
[[nodiscard]] std::vector<std::string> groupsOf(const CommandTable& command);

/// The options under one of these headings.
[[nodiscard]] std::vector<const Parameter*> inGroup(const CommandTable& command, const std::string& group);

/// "--window N", "SCAN...", "--keep FILE": the name and what it takes.
[[nodiscard]] std::string signatureOf(const Parameter& parameter);

/// "fettle filter [options] FILES...".
[[nodiscard]] std::string usageOf(const CommandTable& command);

/// The words that it takes, as typed.
[[nodiscard]] std::vector<std::string> wordsOf(const Parameter& parameter);

/// The words that completion offers: those that it takes, or the proposed ones.
[[nodiscard]] std::vector<std::string> offeredBy(const Parameter& parameter);

/// Range, words, default, and what it excludes: "1 to 1001 samples; default 3". May be empty.
[[nodiscard]] std::string factsOf(const Parameter& parameter);

/// Its text with its facts in brackets, as one sentence without the period.
[[nodiscard]] std::string describe(const Parameter& parameter);

/// `command` and all below it, depth first.
void forEachCommand(const CommandTable& command, const std::function<void(const CommandTable&)>& f);

}  // namespace fettle::app
