#include "app/commands/program.h"

int main(int argc, char** argv) {
  using namespace fettle::app;
  return runProgram(argc, argv, [](Command root, Chosen& chosen) {
    addInfo(root, chosen);
    addSynth(root, chosen);
    addFilter(root, chosen);
    addLevel(root, chosen);
    addMeasure(root, chosen);
    addMark(root, chosen);
    addLines(root, chosen);
    addReplay(root, chosen);
    addRecord(root, chosen);
    addRecipe(root, chosen);
    addApply(root, chosen);
    addJournal(root, chosen);
    addRender(root, chosen);
    addCompare(root, chosen);
    addConvert(root, chosen);
    addDevices(root, chosen);
    addView(root, chosen);
    addAccuracy(root, chosen);
    addDemo(root, chosen);
    addBench(root, chosen);
    addReference(root, chosen);
  });
}
