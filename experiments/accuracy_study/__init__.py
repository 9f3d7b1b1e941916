"""The accuracy study: random questions (`slabs`, `cases`, `hard`), an independent truth (`source`, `medium`, `near_axis`,
`misplaced`, `contour`, `reference`), their comparison (`study`), and what is printed of it (`report`, `limit`, `terms`).
"""
