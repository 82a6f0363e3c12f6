#include "app/commands/program.h"
#include "app/thread_left.h"

int main(int argc, char** argv) {
  using namespace fettle::app;
  const int status = runProgram(argc, argv, [](Command root, Chosen& chosen) {
    addScanCommands(root, chosen);
    addPlan(root, chosen);
    addGather(root, chosen);
    addStatus(root, chosen);
    addSubmit(root, chosen);
    addRecord(root, chosen);
    addDevices(root, chosen);
    addView(root, chosen);
    addAccuracy(root, chosen);
    addDemo(root, chosen);
    addBench(root, chosen);
    addReference(root, chosen);
  });
  return endOfMain(status);
}
