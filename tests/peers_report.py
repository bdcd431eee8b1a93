from peers_table import limit_table
def page(command, rows): return command+"\n\n"+limit_table(rows)+"\n"
