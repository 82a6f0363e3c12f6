#include "app/commands/command.h"

namespace fettle::app {

void addScanCommands(Command root, Chosen& chosen) {
  addInfo(root, chosen);
  addSynth(root, chosen);
  addFilter(root, chosen);
  addLevel(root, chosen);
  addFill(root, chosen);
  addRemove(root, chosen);
  addTransform(root, chosen);
  addMeasure(root, chosen);
  addSection(root, chosen);
  addFeatures(root, chosen);
  addFit(root, chosen);
  addReport(root, chosen);
  addMark(root, chosen);
  addLines(root, chosen);
  addReplay(root, chosen);
  addRecipe(root, chosen);
  addApply(root, chosen);
  addJournal(root, chosen);
  addRender(root, chosen);
  addAlign(root, chosen);
  addMosaic(root, chosen);
  addCompare(root, chosen);
  addConvert(root, chosen);
}

}  // namespace fettle::app
