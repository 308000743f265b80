/* What GCC 12's libstdc++.a and libgcc_eh.a take from glibc after 2.28. Linked into each library and program. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <link.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <unistd.h>

/* 2.32: whether one thread alone has ever been; 0 is always right */
char __libc_single_threaded;

/* 2.36: std::random_device */
uint32_t arc4random(void) {
  uint32_t number;
  if (getentropy(&number, sizeof number) != 0) abort();
  return number;
}

/* 2.35: which module holds an address, and where its tables for unwinding are */
struct search {
  ElfW(Addr) address;
  struct dl_find_object* out;
};

static int holds(struct dl_phdr_info* info, size_t size, void* data) {
  struct search* s = data;
  const ElfW(Phdr)* frames = NULL;
  int inside = 0;
  (void)size;
  for (int k = 0; k < info->dlpi_phnum; ++k) {
    const ElfW(Phdr)* p = &info->dlpi_phdr[k];
    const ElfW(Addr) first = info->dlpi_addr + p->p_vaddr;
    if (p->p_type == PT_GNU_EH_FRAME) frames = p;
    if (p->p_type != PT_LOAD || s->address < first || s->address >= first + p->p_memsz) continue;
    inside = 1;
    s->out->dlfo_map_start = (void*)first;
    s->out->dlfo_map_end = (void*)(first + p->p_memsz);
  }
  if (!inside || !frames) return 0;
  s->out->dlfo_flags = 0;
  s->out->__dflo_reserved[0] = info->dlpi_addr;
  s->out->dlfo_link_map = (void*)s->out->__dflo_reserved; /* of which unwinding reads the first member alone, l_addr */
  s->out->dlfo_eh_frame = (void*)(info->dlpi_addr + frames->p_vaddr);
  return 1;
}

int _dl_find_object(void* address, struct dl_find_object* out) {
  struct search s = {(ElfW(Addr))address, out};
  return dl_iterate_phdr(holds, &s) == 1 ? 0 : -1;
}
