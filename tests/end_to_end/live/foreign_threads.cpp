// What the thread sanitizer must ignore in libraries whose code it does not see, in each program that links
// this: it knows neither the order that oneTBB keeps between a task's making and its running, nor that GDAL's
// locks are taken in two orders only while it sets itself up. The live loop uses neither of them.
// Seen by the sanitizer, which is a library of its own.
extern "C" __attribute__((visibility("default"))) const char* __tsan_default_suppressions();
extern "C" const char* __tsan_default_suppressions() {
  return "deadlock:libgdal.so\n"
         "called_from_lib:libgdal.so\n"
         "race:libtbb.so\n";
}
