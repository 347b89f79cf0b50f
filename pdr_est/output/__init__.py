"""Write files: the only place of the package that opens one for writing.

=============  =========================================================================================
file           content
=============  =========================================================================================
atomic_output  files and folders that appear completely or not at all, and never in place of an input
own_files      single files in a folder that others use, too
staging        hidden folders beside a result, in which it is made, and what killed programs left of them
call_inputs    what a call has read, which it never replaces
write_errors   the words for a file that cannot be written
file_lock      one program at a time
=============  =========================================================================================
"""
