"""The accuracy study. `case`: a question; `reference`: its field, computed independently of the package; `cases`: random
questions by number, and questions built for one purpose; `study`: the package compared with the reference, and what is printed.
"""
