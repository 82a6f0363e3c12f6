#include "app/texts/plural_rule.h"

#include <algorithm>
#include <array>
#include <utility>

namespace fettle::app {
namespace {

constexpr int kDeepest = 32;           // parentheses and conditions in each other
constexpr std::size_t kLongest = 512;  // characters; those of Arabic are 80

// Reads and computes at once: an expression is short, and forms are asked for seldom. Both sides of a condition are read.
class PluralReader {
 public:
  PluralReader(std::string_view text, unsigned long long n) : text_(text), n_(n) {}

  // Nothing where it does not read as an expression.
  std::optional<unsigned long long> all() {
    const unsigned long long value = condition();
    if (!good_ || !text_.empty()) return std::nullopt;
    return value;
  }

 private:
  bool take(std::string_view token) {
    if (!text_.starts_with(token)) return false;
    text_.remove_prefix(token.size());
    return true;
  }
  unsigned long long condition() {
    if (++depth_ > kDeepest) good_ = false;
    unsigned long long value = good_ ? binary(0) : 0;
    if (good_ && take("?")) {
      const unsigned long long yes = condition();
      if (!take(":")) good_ = false;
      const unsigned long long no = good_ ? condition() : 0;
      value = value != 0 ? yes : no;
    }
    --depth_;
    return value;
  }
  // Operators by rising precedence; of two with the same beginning the longer one first.
  unsigned long long binary(std::size_t level) {
    static constexpr std::array<std::array<std::string_view, 4>, 6> kLevels{{{"||", "", "", ""},
                                                                             {"&&", "", "", ""},
                                                                             {"==", "!=", "", ""},
                                                                             {"<=", ">=", "<", ">"},
                                                                             {"+", "-", "", ""},
                                                                             {"*", "/", "%", ""}}};
    if (level == kLevels.size()) return unary();
    unsigned long long left = binary(level + 1);
    while (good_) {
      const auto* const op = std::ranges::find_if(
          kLevels[level], [&](std::string_view each) { return !each.empty() && take(each); });
      if (op == kLevels[level].end()) break;
      left = applied(*op, left, binary(level + 1));
    }
    return left;
  }
  unsigned long long applied(std::string_view op, unsigned long long a, unsigned long long b) {
    if (op == "||") return a != 0 || b != 0 ? 1 : 0;
    if (op == "&&") return a != 0 && b != 0 ? 1 : 0;
    if (op == "==") return a == b ? 1 : 0;
    if (op == "!=") return a != b ? 1 : 0;
    if (op == "<=") return a <= b ? 1 : 0;
    if (op == ">=") return a >= b ? 1 : 0;
    if (op == "<") return a < b ? 1 : 0;
    if (op == ">") return a > b ? 1 : 0;
    if (op == "+") return a + b;
    if (op == "-") return a - b;
    if (op == "*") return a * b;
    // What an unreached side divides by does not matter.
    if (b == 0) return 0;
    return op == "/" ? a / b : a % b;
  }
  unsigned long long unary() {
    bool negated = false;
    while (take("!")) negated = !negated;
    const unsigned long long value = primary();
    return negated ? (value == 0 ? 1 : 0) : value;
  }
  unsigned long long primary() {
    if (take("n")) return n_;
    if (take("(")) {
      const unsigned long long value = condition();
      if (!take(")")) good_ = false;
      return value;
    }
    unsigned long long value = 0;
    bool any = false;
    while (!text_.empty() && text_.front() >= '0' && text_.front() <= '9') {
      value = 10 * value + static_cast<unsigned long long>(text_.front() - '0');
      text_.remove_prefix(1);
      any = true;
    }
    if (!any) good_ = false;
    return value;
  }

  std::string_view text_;
  unsigned long long n_;
  int depth_ = 0;
  bool good_ = true;
};

// What stands between `name`= and the next semicolon, without spaces.
std::optional<std::string> valueOf(std::string_view header, std::string_view name) {
  std::string text(header);
  std::erase_if(text, [](char c) { return c == ' ' || c == '\t'; });
  std::size_t at = text.find(name);
  if (at == std::string::npos) return std::nullopt;
  at += name.size();
  const std::size_t end = text.find(';', at);
  return text.substr(at, end == std::string::npos ? end : end - at);
}

}  // namespace

std::optional<PluralRule> PluralRule::read(std::string_view header) {
  if (header.size() > kLongest) return std::nullopt;
  const auto forms = valueOf(header, "nplurals="), expression = valueOf(header, ";plural=");
  if (!forms || !expression || forms->empty() || forms->size() > 2) return std::nullopt;
  PluralRule rule;
  rule.forms_ = 0;
  for (const char c : *forms) {
    if (c < '0' || c > '9') return std::nullopt;
    rule.forms_ = 10 * rule.forms_ + static_cast<std::size_t>(c - '0');
  }
  if (rule.forms_ < 1 || rule.forms_ > kMostForms) return std::nullopt;
  if (!PluralReader(*expression, 1).all()) return std::nullopt;
  rule.expression_ = *expression;
  return rule;
}

std::size_t PluralRule::formOf(unsigned long long n) const noexcept {
  const auto form = PluralReader(expression_, n).all();
  return std::min(static_cast<std::size_t>(form.value_or(0)), forms_ - 1);
}

}  // namespace fettle::app
