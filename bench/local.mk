# see DESIGN; files of bench/, one a line
