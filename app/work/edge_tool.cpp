#include "app/work/edge_tool.h"

#include "app/work/line_edits.h"
#include "engine/field/difference.h"
#include "engine/field/live_field.h"

namespace fettle::app {

void EdgeTool::search(const LoopClient& client) {
  drop();
  using Shared = std::shared_ptr<const Found>;
  searching_.replace(
      [field = client.newest(), scale = sigma](engine::JobControl& job) -> engine::Result<Shared> {
        auto map = engine::findEdges(field, scale, job);
        if (!map) return tl::unexpected(map.error());
        return std::make_shared<const Found>(Found{field, std::move(*map)});
      });
}

void EdgeTool::redraw(const LoopClient& client) {
  if (!found_) return;
  if (drawing_.busy()) {
    draw_again_ = true;
    return;
  }
  draw_again_ = false;
  drawing_.replace([base = client.newest(), found = found_,
                    what = choice](engine::JobControl& job) -> engine::Result<Drawn> {
    auto suggestion = engine::suggestMarks(base, found->map, what, job);
    if (!suggestion) return tl::unexpected(suggestion.error());
    return Drawn{what, base, std::move(*suggestion)};
  });
}

void EdgeTool::drop() {
  searching_.cancel();
  drawing_.cancel();
  draw_again_ = false;
  found_.reset();
  shown_.reset();
  base_ = under_ = over_ = {};
}

TakenEdges EdgeTool::taken() const {
  return {{found_->map.sigma, drawn_.sensitivity, drawn_.thickness}, found_->field};
}

bool EdgeTool::accept(LoopClient& client) {
  if (!shown_) return false;
  if (!(shown_->field == base_))
    static_cast<void>(client.change(base_, shown_->field, "Edge suggestion", taken()));
  drop();
  return true;
}

bool EdgeTool::acceptAsLines(MarkEdit& edit) {
  if (!shown_) return false;
  edit.ask(
      "Edge lines",
      [found = found_, what = drawn_](const engine::Version& base, engine::JobControl& job) {
        return drawSuggestion(base, found->map, what, job);
      },
      {"none of the suggested edges could be located", "take them as marks (Shift+E)"}, taken());
  drop();
  return true;
}

bool EdgeTool::poll(LoopClient& client, std::vector<Notice>& notices) {
  bool changed = false;
  const auto refused = [&](const engine::Error& error) {
    if (error.kind != engine::ErrorKind::kCancelled) notices.push_back({error.what, error.remedy});
  };
  // A cancelled job may have finished meanwhile.
  const bool search_dropped = searching_.cancelling(), drawing_dropped = drawing_.cancelling();
  if (auto found = searching_.take(); found && !search_dropped) {
    changed = true;
    if (*found) {
      found_ = std::move(**found);
      redraw(client);
    } else {
      refused(found->error());
    }
  }
  if (auto drawn = drawing_.take(); drawn && !drawing_dropped) {
    changed = true;
    if (*drawn) {
      base_ = (*drawn)->base;
      drawn_ = (*drawn)->choice;
      shown_ = std::move((*drawn)->suggestion);
      under_ = base_;
      over_ = shown_->field;
    } else {
      refused(drawn->error());
    }
    if (draw_again_) redraw(client);
  }
  return changed;
}

engine::Version EdgeTool::over(const engine::Version& live) {
  if (!shown_) return live;
  const engine::Version upright = LoopClient::upright(live);
  if (!(upright == under_)) {
    engine::LiveField field(over_, engine::Growth::kAllowed);
    const engine::FieldReader marks = shown_->field.reader();
    for (const engine::TileChange& change : engine::changedTiles(under_, upright)) {
      engine::TileRef tile = field.newTile();
      if (!tile) return live;
      *tile = *change.after;
      const engine::Tile& wanted = marks.tile(change.tile_column, change.tile_row);
      for (std::size_t r = 0; r < tile->marks.size(); ++r) tile->marks[r] |= wanted.marks[r];
      engine::refreshMarks(*tile);
      if (!field.replaceTile(change.tile_column, change.tile_row, std::move(tile))) return live;
    }
    over_ = field.snapshot();
    under_ = upright;
  }
  return live.reader().sign() < 0.0F ? over_.inverted() : over_;
}

}  // namespace fettle::app
