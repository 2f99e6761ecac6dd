// A function, an inline one and its static: g++ makes the static one of the whole process.
__attribute__((noinline)) inline int& calls() {
  static int count = 0;
  return count;
}
extern "C" int count_call() { return ++calls(); }
