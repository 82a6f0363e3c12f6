#include "app/window/panels/moves_choice.h"

#include <vector>

#include <imgui.h>

#include "app/texts/texts.h"

namespace fettle::app {

bool chooseMoves(const char* id, std::optional<engine::AlignMoves>& moves, const char* none) {
  std::vector<const char*> texts;
  int chosen = static_cast<int>(kNamedMoves.size());  // `none`
  for (const NamedMoves& named : kNamedMoves) {
    if (moves == named.moves) chosen = static_cast<int>(texts.size());
    texts.push_back(tr(named.on_screen));
  }
  if (none != nullptr) texts.push_back(tr(none));
  if (!ImGui::Combo(id, &chosen, texts.data(), static_cast<int>(texts.size()))) return false;
  const auto place = static_cast<std::size_t>(chosen);
  moves = place < kNamedMoves.size() ? std::optional(kNamedMoves[place].moves) : std::nullopt;
  return true;
}

}  // namespace fettle::app
