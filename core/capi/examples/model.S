/* Model files in read-only memory, each on a 16-byte boundary: MODEL and SECOND_MODEL are their paths. */
#ifndef SECOND_MODEL
#define SECOND_MODEL MODEL
#endif

    .section .rodata.model, "a"
    .balign 16
    .global capsule_file, capsule_file_end
capsule_file:
    .incbin MODEL
capsule_file_end:

    .balign 16
    .global second_file, second_file_end
second_file:
    .incbin SECOND_MODEL
second_file_end:

#ifdef __ELF__
    .section .note.GNU-stack, "", %progbits
#endif
