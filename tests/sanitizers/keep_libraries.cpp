// Linked into programs of windows under the address sanitizer: a driver that stays loaded can be named in
// lsan.supp; what an unloaded one has left cannot.
extern "C" int dlclose(void*) {
  return 0;
}
