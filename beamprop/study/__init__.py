"""Studies: one question at all points of a grid of parameters, block by block, in many processes, through kills.

Order of the files here: `axes`, `blocks`, `fingerprint` and `claims` know neither questions' answers nor files; `work` answers the points of a
block; `store` and `arrays` keep blocks; `engine` runs them; `sweep` is the question.
"""
